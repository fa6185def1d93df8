(** Paired, weighted clouds; the paper's forces and energies, point by point.

    Definitions only, in the paper's words: masses m_i = w_i, springs k_i = 2 w_i, damping mu m_i v_i.
    The clouds may lie anywhere: they are centred here, and t belongs to the clouds as given. *)

Require Import Reals Lra List.
From Certreg Require Import Vectors.
Open Scope R_scope.

Record pair := Pair { weight : R; source : vec; target : vec }.
Definition cloud := list pair.

Fixpoint sum (f : pair -> R) (l : cloud) : R :=
  match l with nil => 0 | p :: rest => f p + sum f rest end.
Fixpoint vsum (f : pair -> vec) (l : cloud) : vec :=
  match l with nil => vzero | p :: rest => vadd (f p) (vsum f rest) end.
Fixpoint msum (f : pair -> mat) (l : cloud) : mat :=
  match l with nil => mzero | p :: rest => madd (f p) (msum f rest) end.

Definition mass (l : cloud) := sum weight l.
Definition centre (g : pair -> vec) (l : cloud) :=
  vscale (/ mass l) (vsum (fun p => vscale (weight p) (g p)) l).

(** Both clouds with their weighted means subtracted: the paper's x~_i and y~_i. *)
Definition centred (l : cloud) : cloud :=
  map (fun p => Pair (weight p) (vsub (source p) (centre source l))
                                (vsub (target p) (centre target l))) l.

Definition cross_covariance l :=
  msum (fun p => mscale (weight p) (outer (target p) (source p))) (centred l).
Definition scatter l :=
  msum (fun p => mscale (weight p) (outer (source p) (source p))) (centred l).
(** J = - sum m [x~]^2. *)
Definition inertia l :=
  msum (fun p => mscale (- weight p) (mmul (hat (source p)) (hat (source p)))) (centred l).

(** What is minimised: sum w |y - R x - t|^2 over rotations R and all t. *)
Definition residual R t p := vsub (vsub (target p) (mvec R (source p))) t.
Definition objective l R t := sum (fun p => weight p * norm2 (residual R t p)) l.

(** c, R in the frame of the target; v, the velocity of c; omega, in the body's frame. *)
Record state := State { position : vec; attitude : mat; velocity : vec; spin : vec }.

Definition spring (p : pair) := 2 * weight p.
Definition stretch s p :=
  vsub (vsub (target p) (mvec (attitude s) (source p))) (position s).
Definition point_velocity s p :=
  vadd (mvec (attitude s) (cross (spin s) (source p))) (velocity s).
Definition point_force mu s p :=
  vsub (vscale (spring p) (stretch s p)) (vscale (mu * weight p) (point_velocity s p)).

Definition force mu l s := vsum (point_force mu s) (centred l).
(** About the centre of mass, in the body's frame. *)
Definition torque mu l s :=
  vsum (fun p => cross (source p) (mvec (transpose (attitude s)) (point_force mu s p))) (centred l).
Definition potential l s := sum (fun p => spring p / 2 * norm2 (stretch s p)) (centred l).
Definition kinetic l s := sum (fun p => weight p / 2 * norm2 (point_velocity s p)) (centred l).
Definition energy l s := kinetic l s + potential l s.
(** What damping takes away per unit of time: sum mu m |v_i|^2. *)
Definition dissipated mu l s :=
  sum (fun p => mu * weight p * norm2 (point_velocity s p)) (centred l).

(** Newton and Euler: all rates of change vanish. *)
Definition equilibrium mu l s :=
  velocity s = vzero /\ mmul (attitude s) (hat (spin s)) = mzero /\
  force mu l s = vzero /\
  vsub (torque mu l s) (cross (spin s) (mvec (inertia l) (spin s))) = vzero.
