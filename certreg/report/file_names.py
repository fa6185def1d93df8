"""The names of the files that `certify --out` and `demo` write into a folder."""

from __future__ import annotations

CERTIFICATE, RESULT, POSE = "certificate.json", "result.json", "pose.txt"
SURE_POSE = "pose.json"  # with its uncertainty: in the matrix other programs read no words
TRAJECTORY, REPORT, FIT = "trajectory.npz", "report.html", "fit.csv"
FILES = (CERTIFICATE, RESULT, POSE, SURE_POSE, FIT, TRAJECTORY, REPORT)
