"""Results for readers: JSON documents for programs, plain sentences for people."""
