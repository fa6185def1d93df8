"""The commands, by what they are about; `certreg.cli.main` puts them together."""
