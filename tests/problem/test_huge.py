"""A sample of `make rates NAME=mapped_clouds`: two clouds of 25 MB in the place of 8 GB."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks.rates.mapped_clouds import Run, size, turn, write_clouds
from certreg import RegistrationProblem, verify
from certreg.certificate.blockwise import check_on_sums

POINTS = 1_050_000  # more than a certificate holds
MEGABYTES = 45  # of the 50 that both files have; 16 are the stacks of two threads


@pytest.mark.long
def test_mapped_clouds_are_certified_in_less_memory_than_they_take(tmp_path):
    files = write_clouds(tmp_path, POINTS)
    run = Run.of(*files, tmp_path / "certificate.json", MEGABYTES)

    assert run.n == POINTS
    assert run.status == "CERTIFIED"
    assert np.abs(run.rotation - turn()).max() < 1e-3
    assert sum(file.stat().st_size for file in files) > MEGABYTES << 20

    content = (tmp_path / "certificate.json").read_bytes()
    mapped = RegistrationProblem(*(np.load(file, mmap_mode="r") for file in files))
    assert len(content) < 2000
    assert "give SOURCE and TARGET" in verify(content).words
    assert check_on_sums(content, mapped).verified


def test_the_size_is_what_the_disk_allows():
    assert size(1000.0, 8.0) == 8.0
    assert size(8.0, 8.0) == 3.0
