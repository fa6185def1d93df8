/* The springs of one body beside its inertia, by pencil.c. */

/* The eigenvalues, ascending, of the pencil (G, J): at the optimum a small turn phi has the energy phi^T G phi / 2,
 * G = 2 tr(A) I - A - A^T, A = R(q)^T C. q: a unit quaternion; cross: C row by row; inertia: the upper triangle of J.
 * 0 where rounding leaves J without a root. */
int certreg_pencil(const double q[4], const double cross[9], const double inertia[6], double ratios[3]);
