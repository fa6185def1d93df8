(** The certified basin: a moving body that can end nowhere but at the optimum.

    Claimed: where tr(R^T C) - omega^T J omega / 4 exceeds a level above the second eigenvalue of K, no
    spurious equilibrium has so little energy of rotation; so along any solution from there, whatever
    the damping, every balanced limit of the attitude is the optimum.
    Not claimed: LaSalle's theorem, that every limit of the attitude is balanced; it is a hypothesis
    of the last theorem. *)

Require Import Reals Lra List.
From Coquelicot Require Import Coquelicot.
From Certreg Require Import Vectors Quaternions Davenport Spectral Clouds Moments Equilibria Dynamics
  Certificate.
Open Scope R_scope.

Definition in_certified_basin l level s :=
  level < trace (mmul (transpose (attitude s)) (cross_covariance l))
          - / 4 * quadratic (inertia l) (spin s).

Lemma basin_energy l level s : in_certified_basin l level s <-> spin_energy l s < - 2 * level.
Proof. unfold in_certified_basin, spin_energy, quadratic. lra. Qed.

(** A balanced rotation with tr(R^T C) above the second eigenvalue is optimal. *)
Theorem balanced_above_second_is_optimal C k u R : spectral (davenport C) k u -> balanced C R ->
  k I2 < trace (mmul (transpose R) C) -> optimal_rotation C R.
Proof.
  intros S B H. destruct (balanced_has_eigenvector C R k u S B) as (q & i & Hq & <- & E).
  rewrite <- davenport_form, (eigen_form _ _ q Hq E) in H.
  apply (optimal_iff_top_eigenvector C k u q S Hq).
  destruct (order _ _ _ S) as (D1 & D2 & D3).
  destruct i; [assumption | | |]; exfalso; lra.
Qed.

(** No spurious equilibrium, at rest, has as little energy as a state in the basin. *)
Theorem no_spurious_equilibrium_in_basin l k u level s R v :
  spectral (davenport (cross_covariance l)) k u -> k I2 < level -> in_certified_basin l level s ->
  balanced (cross_covariance l) R ->
  spin_energy l (State v R vzero vzero) <= spin_energy l s ->
  optimal_rotation (cross_covariance l) R.
Proof.
  intros S L I B E. apply basin_energy in I.
  apply (balanced_above_second_is_optimal _ k u R S B).
  unfold spin_energy in E at 1. cbn [spin attitude] in E.
  replace (dot vzero (mvec (inertia l) vzero)) with 0 in E
    by (generalize (inertia l); clear; by_components). lra.
Qed.

(** Rotations whose entries differ by less than eps. *)
Definition near eps P R :=
  Rabs (m11 P - m11 R) < eps /\ Rabs (m12 P - m12 R) < eps /\ Rabs (m13 P - m13 R) < eps /\
  Rabs (m21 P - m21 R) < eps /\ Rabs (m22 P - m22 R) < eps /\ Rabs (m23 P - m23 R) < eps /\
  Rabs (m31 P - m31 R) < eps /\ Rabs (m32 P - m32 R) < eps /\ Rabs (m33 P - m33 R) < eps.

(** The attitude comes back to every neighbourhood of R for ever. *)
Definition limit_attitude (D : R -> Prop) s R :=
  forall eps T, 0 < eps -> exists t, D t /\ T < t /\ near eps (attitude (s t)) R.

Definition entry_sum C :=
  Rabs (m11 C) + Rabs (m12 C) + Rabs (m13 C) + Rabs (m21 C) + Rabs (m22 C) + Rabs (m23 C)
  + Rabs (m31 C) + Rabs (m32 C) + Rabs (m33 C).

Lemma near_trace eps P R C : near eps P R ->
  trace (mmul (transpose P) C) <= trace (mmul (transpose R) C) + eps * entry_sum C.
Proof.
  intros (N1 & N2 & N3 & N4 & N5 & N6 & N7 & N8 & N9).
  assert (B : forall x y c, Rabs (x - y) < eps -> x * c <= y * c + eps * Rabs c).
  { intros x y c H. enough ((x - y) * c <= eps * Rabs c) by lra.
    apply Rle_trans with (Rabs ((x - y) * c)); [apply RRle_abs|].
    rewrite Rabs_mult. apply Rmult_le_compat_r; [apply Rabs_pos | lra]. }
  apply (B _ _ (m11 C)) in N1. apply (B _ _ (m12 C)) in N2. apply (B _ _ (m13 C)) in N3.
  apply (B _ _ (m21 C)) in N4. apply (B _ _ (m22 C)) in N5. apply (B _ _ (m23 C)) in N6.
  apply (B _ _ (m31 C)) in N7. apply (B _ _ (m32 C)) in N8. apply (B _ _ (m33 C)) in N9.
  clear B. unfold entry_sum. destruct P, R, C. unfold_vectors. lra.
Qed.

(** Along a solution that starts in the basin, a limit of the attitude that is balanced is optimal. *)
Theorem balanced_limits_in_basin_are_optimal mu l k u level D s t0 R :
  0 <= mu -> mass l <> 0 -> (forall x, 0 <= quadratic (inertia l) x) ->
  spectral (davenport (cross_covariance l)) k u -> k I2 < level ->
  solution mu l D s -> D t0 -> rotation (attitude (s t0)) -> in_certified_basin l level (s t0) ->
  limit_attitude D s R -> balanced (cross_covariance l) R ->
  optimal_rotation (cross_covariance l) R.
Proof.
  intros Hmu HM PJ S L Sol H0 R0 I Lim B. apply basin_energy in I.
  apply (balanced_above_second_is_optimal _ k u R S B).
  assert (E : forall eps, 0 < eps ->
    - / 2 * spin_energy l (s t0) <=
    trace (mmul (transpose R) (cross_covariance l)) + eps * entry_sum (cross_covariance l)).
  { intros eps He. destruct (Lim eps t0 He) as (t & Ht & Lt & N).
    pose proof (near_trace eps _ R (cross_covariance l) N) as T.
    pose proof (spin_energy_never_rises mu l D s t0 t Hmu PJ HM Sol R0 H0 Ht) as F.
    unfold spin_energy in F at 1. specialize (PJ (spin (s t))). unfold quadratic in PJ. lra. }
  apply Rlt_le_trans with (- / 2 * spin_energy l (s t0)); [lra|].
  apply le_epsilon. intros eps He.
  assert (Q : 0 <= entry_sum (cross_covariance l))
    by (unfold entry_sum; repeat apply Rplus_le_le_0_compat; apply Rabs_pos).
  specialize (E (eps / (entry_sum (cross_covariance l) + 1))).
  assert (0 < eps / (entry_sum (cross_covariance l) + 1)) by (apply Rdiv_lt_0_compat; lra).
  assert (eps / (entry_sum (cross_covariance l) + 1) * entry_sum (cross_covariance l) <= eps).
  { apply Rle_trans with (eps / (entry_sum (cross_covariance l) + 1)
      * (entry_sum (cross_covariance l) + 1)); [|right; field; lra].
    apply Rmult_le_compat_l; lra. }
  specialize (E H). lra.
Qed.

(** With LaSalle's theorem as a hypothesis: the attitude has no limit but the only optimum. *)
Theorem motion_from_basin_ends_at_the_optimum mu l k u level D s t0 :
  0 <= mu -> mass l <> 0 -> (forall x, 0 <= quadratic (inertia l) x) ->
  spectral (davenport (cross_covariance l)) k u -> k I2 < level ->
  solution mu l D s -> D t0 -> rotation (attitude (s t0)) -> in_certified_basin l level (s t0) ->
  (forall R, limit_attitude D s R -> balanced (cross_covariance l) R) ->
  exists best, optimal_rotation (cross_covariance l) best /\
               forall R, limit_attitude D s R -> R = best.
Proof.
  intros Hmu HM PJ S L Sol H0 R0 I LaSalle.
  assert (gap : k I2 < k I1).
  { destruct (every_rotation_has_a_quaternion _ R0) as (q & Hq & E).
    pose proof (largest_value _ k u q S) as V. rewrite Hq, davenport_form, E in V.
    unfold in_certified_basin in I. specialize (PJ (spin (s t0))). lra. }
  destruct (proj2 (unique_optimum_iff_simple_top _ k u S) gap) as (best & O & U).
  exists best. split; [assumption|]. intros R HR. apply U.
  apply (balanced_limits_in_basin_are_optimal mu l k u level D s t0 R); auto.
Qed.
