"""Campaigns: many registrations in batches that survive whatever kills them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from certreg._loading import lazy_face

if TYPE_CHECKING:
    from certreg.campaign.listing import read_listing as read_listing
    from certreg.campaign.pairs import RESULTS as RESULTS
    from certreg.campaign.pairs import TABLES as TABLES
    from certreg.campaign.pairs import PairCampaign as PairCampaign
    from certreg.campaign.pairs import Tally as Tally
    from certreg.campaign.pairs import write_pair_results as write_pair_results
    from certreg.campaign.runner import Observer as Observer
    from certreg.campaign.runner import completed as completed
    from certreg.campaign.runner import contents as contents
    from certreg.campaign.runner import in_order as in_order
    from certreg.campaign.runner import run as run
    from certreg.campaign.store import CERTIFICATES as CERTIFICATES
    from certreg.campaign.store import Manifest as Manifest
    from certreg.campaign.store import current_versions as current_versions
    from certreg.campaign.store import occupied as occupied
    from certreg.campaign.table import SUMMARY as SUMMARY
    from certreg.campaign.table import Block as Block
    from certreg.campaign.table import Column as Column
    from certreg.campaign.table import csv_bytes as csv_bytes
    from certreg.campaign.table import records_bytes as records_bytes
    from certreg.campaign.table import require_parquet as require_parquet
    from certreg.campaign.table import write_table as write_table
    from certreg.campaign.task import Task as Task
    from certreg.campaign.task import TaskResult as TaskResult
    from certreg.campaign.workers import LocalWorkers as LocalWorkers
    from certreg.campaign.workers import Workers as Workers
    from certreg.campaign.workers import workers_at as workers_at

__getattr__ = lazy_face(
    __name__,
    {
        "listing": ("read_listing",),
        "pairs": (
            "PairCampaign",
            "RESULTS",
            "TABLES",
            "Tally",
            "write_pair_results",
        ),
        "runner": (
            "Observer",
            "completed",
            "contents",
            "in_order",
            "run",
        ),
        "store": (
            "CERTIFICATES",
            "Manifest",
            "current_versions",
            "occupied",
        ),
        "table": (
            "Block",
            "Column",
            "SUMMARY",
            "csv_bytes",
            "records_bytes",
            "require_parquet",
            "write_table",
        ),
        "task": ("Task", "TaskResult"),
        "workers": ("LocalWorkers", "Workers", "workers_at"),
    },
)
