"""The proofs in Coq: `.v` files, the check of all of them, and what they state, read from them."""
