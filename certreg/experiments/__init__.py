"""The experiments of [Yang2020], each its data and its figure."""
