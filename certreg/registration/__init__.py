"""The main job: register, enumerate, cross-check, certify; and judge other poses."""
