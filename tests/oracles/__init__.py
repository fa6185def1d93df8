"""Independent programs and textbook algorithms that the shipped methods are held against."""
