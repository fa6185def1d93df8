"""The commands, by what they are about; `certreg.cli` puts them together."""
