"""Results that killed campaigns left are swept; those of campaigns at work are not."""

from __future__ import annotations

import errno
import os
import time

import pytest

from certreg.campaign.workers import RESULTS, LocalWorkers
from certreg.certificate.private_folder import STALE


@pytest.mark.slow
def test_results_of_killed_campaigns_are_swept_and_no_others(tmp_path, monkeypatch):
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    killed, fresh = tmp_path / f"{RESULTS}abcd_123", tmp_path / f"{RESULTS}fresh___"
    killed.mkdir()
    fresh.mkdir()
    (killed / "0").write_bytes(b"a result")
    long_ago = time.time() - STALE - 60.0
    with LocalWorkers(1) as at_work:
        assert at_work.place is not None
        for place in (killed, at_work.place):
            os.utime(place, (long_ago, long_ago))
        with LocalWorkers(1):
            assert not killed.exists()
            assert fresh.exists()
            assert at_work.place.exists()
        os.utime(fresh, (long_ago, long_ago))
    assert list(tmp_path.iterdir()) == [fresh]


def test_results_on_a_disk_without_locks_are_left_alone(tmp_path, monkeypatch):
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    monkeypatch.setattr("certreg.campaign.workers.try_lock", no_locks)
    old = tmp_path / f"{RESULTS}abcd_123"
    old.mkdir()
    os.utime(old, (0.0, 0.0))
    with LocalWorkers(1):
        assert old.exists()


def no_locks(_: int) -> bool:
    raise OSError(errno.ENOLCK, "no locks available")
