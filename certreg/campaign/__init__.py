"""Campaigns: many registrations in batches that survive whatever kills them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from certreg._faces import lazy_face

if TYPE_CHECKING:
    from certreg.campaign.calls import Call as Call
    from certreg.campaign.calls import Yield as Yield
    from certreg.campaign.calls import in_order as in_order
    from certreg.campaign.calls import outcomes as outcomes
    from certreg.campaign.folder import occupied as occupied
    from certreg.campaign.listing import read_listing as read_listing
    from certreg.campaign.manifest import Manifest as Manifest
    from certreg.campaign.manifest import current_versions as current_versions
    from certreg.campaign.pairs import RESULTS as RESULTS
    from certreg.campaign.pairs import PairCampaign as PairCampaign
    from certreg.campaign.pairs import Tally as Tally
    from certreg.campaign.pairs import write_pair_results as write_pair_results
    from certreg.campaign.running import CERTIFICATES as CERTIFICATES
    from certreg.campaign.running import SHARDS as SHARDS
    from certreg.campaign.running import Watch as Watch
    from certreg.campaign.running import contents as contents
    from certreg.campaign.running import run as run
    from certreg.campaign.table import SUMMARY as SUMMARY
    from certreg.campaign.table import Block as Block
    from certreg.campaign.table import Column as Column
    from certreg.campaign.table import csv_bytes as csv_bytes
    from certreg.campaign.table import require_parquet as require_parquet
    from certreg.campaign.table import write_table as write_table
    from certreg.campaign.workers import LocalWorkers as LocalWorkers
    from certreg.campaign.workers import workers_at as workers_at

__getattr__ = lazy_face(
    __name__,
    {
        "calls": (
            "Call",
            "Yield",
            "in_order",
            "outcomes",
        ),
        "folder": ("occupied",),
        "listing": ("read_listing",),
        "manifest": (
            "Manifest",
            "current_versions",
        ),
        "pairs": (
            "PairCampaign",
            "RESULTS",
            "Tally",
            "write_pair_results",
        ),
        "running": (
            "CERTIFICATES",
            "SHARDS",
            "Watch",
            "contents",
            "run",
        ),
        "table": (
            "Block",
            "Column",
            "SUMMARY",
            "csv_bytes",
            "require_parquet",
            "write_table",
        ),
        "workers": (
            "LocalWorkers",
            "workers_at",
        ),
    },
)
