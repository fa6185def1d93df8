"""The semidefinite relaxation of the rotation problem: what other methods of registration solve."""
