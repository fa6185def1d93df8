"""Campaigns: many registrations in batches that survive whatever kills them."""
