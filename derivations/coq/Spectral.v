(** The spectral theorem for symmetric 4x4 matrices.

    Claimed: an orthonormal basis of eigenvectors exists, eigenvalues in descending order; hence
    Parseval, the form and the power sums of the eigenvalues. No eigenbasis is ever assumed. *)

Require Import Reals Lra List.
From Certreg Require Import Vectors Quaternions Davenport Extremum.
Open Scope R_scope.

Inductive four := I1 | I2 | I3 | I4.
Definition every : list four := I1 :: I2 :: I3 :: I4 :: nil.
Definition sum4 (f : four -> R) := f I1 + f I2 + f I3 + f I4.

Definition four_eq_dec (i j : four) : {i = j} + {i <> j}.
Proof. decide equality. Defined.

Definition orthonormal (u : four -> quat) :=
  forall i j, qdot (u i) (u j) = if four_eq_dec i j then 1 else 0.

Definition descending (k : four -> R) := k I2 <= k I1 /\ k I3 <= k I2 /\ k I4 <= k I3.

(** A = sum k_i u_i u_i^T with k_1 >= ... >= k_4. *)
Record spectral (A : sym) (k : four -> R) (u : four -> quat) : Prop := Spectral {
  basis : orthonormal u;
  eigenvectors : forall i, eigen A (k i) (u i);
  order : descending k }.

(** How many eigenvalues lie above the [j]-th. *)
Definition above (k : four -> R) (j : four) : nat :=
  length (filter (fun i => if Rlt_dec (k j) (k i) then true else false) every).

Definition choose {X : Type} (a b c d : X) (i : four) : X :=
  match i with I1 => a | I2 => b | I3 => c | I4 => d end.

Lemma eigenvectors_orthogonal A k l p q :
  eigen A k p -> eigen A l q -> k <> l -> qdot p q = 0.
Proof.
  intros Hp Hq H. pose proof (apply_symmetric A p q) as S.
  rewrite Hp, Hq, !qdot_scale_right, (qdot_comm q p) in S.
  assert (Z : (l - k) * qdot p q = 0) by lra.
  apply Rmult_integral in Z. destruct Z; [exfalso; apply H; lra | assumption].
Qed.

Definition e1 := Quat 1 0 0 0.
Definition e2 := Quat 0 1 0 0.
Definition e3 := Quat 0 0 1 0.
Definition e4 := Quat 0 0 0 1.

Lemma trace_bound A k : (forall p, form A p <= k * qnorm2 p) -> strace A <= 4 * k.
Proof.
  intro H. pose proof (H e1) as H1. pose proof (H e2) as H2.
  pose proof (H e3) as H3. pose proof (H e4) as H4.
  destruct A. unfold e1, e2, e3, e4 in *. unfold_forms. lra.
Qed.

Lemma trace_square A k p : strace (sadd_square k p A) = strace A + k * qnorm2 p.
Proof. by_forms. Qed.

Lemma eigen_deflated A k c u p :
  qdot u p = 0 -> eigen A k p <-> eigen (sadd_square c u A) k p.
Proof.
  intro H. unfold eigen. rewrite apply_square, H.
  replace (qadd (apply A p) (qscale (c * 0) u)) with (apply A p); [tauto|].
  generalize (apply A p). by_entries.
Qed.

Lemma eigen_deflated_self A k c u :
  unit u -> eigen A k u -> eigen (sadd_square c u A) (k + c) u.
Proof.
  intros Hu H. unfold eigen in *. rewrite apply_square, H. fold (qnorm2 u). rewrite Hu. by_entries.
Qed.

(** Every symmetric 4x4 matrix has an orthonormal basis of eigenvectors. *)
Theorem spectral_theorem A : exists k u, spectral A k u.
Proof.
  destruct (top_eigenvector A) as (k1 & u1 & U1 & E1 & M1).
  pose proof (trace_bound A k1 M1) as T1.
  set (c := 4 * k1 - strace A + 1).
  assert (C : 1 <= c) by (unfold c; lra).
  destruct (top_eigenvector (sadd_square (-c) u1 A)) as (k2 & u2 & U2 & E2 & M2).
  pose proof (trace_bound _ k2 M2) as T2. rewrite trace_square, U1 in T2.
  pose proof (eigen_deflated_self A k1 (-c) u1 U1 E1) as D11.
  assert (O12 : qdot u1 u2 = 0)
    by (apply (eigenvectors_orthogonal _ _ _ _ _ D11 E2); unfold c in *; lra).
  destruct (top_eigenvector (sadd_square (-c) u2 (sadd_square (-c) u1 A)))
    as (k3 & u3 & U3 & E3 & M3).
  pose proof (trace_bound _ k3 M3) as T3. rewrite !trace_square, U1, U2 in T3.
  assert (O21 : qdot u2 u1 = 0) by (rewrite qdot_comm; assumption).
  pose proof (proj1 (eigen_deflated _ _ (-c) u2 u1 O21) D11) as D21.
  pose proof (eigen_deflated_self _ k2 (-c) u2 U2 E2) as D22.
  assert (A2 : eigen A k2 u2) by (apply (eigen_deflated A k2 (-c) u1 u2 O12); assumption).
  assert (k2 <= k1).
  { pose proof (M1 u2) as H. rewrite (eigen_form A k2 u2 U2 A2), U2 in H. lra. }
  assert (O13 : qdot u1 u3 = 0)
    by (apply (eigenvectors_orthogonal _ _ _ _ _ D21 E3); unfold c in *; lra).
  assert (O23 : qdot u2 u3 = 0)
    by (apply (eigenvectors_orthogonal _ _ _ _ _ D22 E3); unfold c in *; lra).
  pose proof (proj2 (eigen_deflated _ _ (-c) u2 u3 O23) E3) as B3.
  pose proof (proj2 (eigen_deflated _ _ (-c) u1 u3 O13) B3) as A3.
  assert (k3 <= k2).
  { pose proof (M2 u3) as H0. rewrite (eigen_form _ k3 u3 U3 B3), U3 in H0. lra. }
  destruct (top_eigenvector (sadd_square (-c) u3 (sadd_square (-c) u2 (sadd_square (-c) u1 A))))
    as (k4 & u4 & U4 & E4 & M4).
  pose proof (trace_bound _ k4 M4) as T4. rewrite !trace_square, U1, U2, U3 in T4.
  assert (O31 : qdot u3 u1 = 0) by (rewrite qdot_comm; assumption).
  assert (O32 : qdot u3 u2 = 0) by (rewrite qdot_comm; assumption).
  pose proof (proj1 (eigen_deflated _ _ (-c) u3 u1 O31) D21) as D31.
  pose proof (proj1 (eigen_deflated _ _ (-c) u3 u2 O32) D22) as D32.
  pose proof (eigen_deflated_self _ k3 (-c) u3 U3 E3) as D33.
  assert (O14 : qdot u1 u4 = 0)
    by (apply (eigenvectors_orthogonal _ _ _ _ _ D31 E4); unfold c in *; lra).
  assert (O24 : qdot u2 u4 = 0)
    by (apply (eigenvectors_orthogonal _ _ _ _ _ D32 E4); unfold c in *; lra).
  assert (O34 : qdot u3 u4 = 0)
    by (apply (eigenvectors_orthogonal _ _ _ _ _ D33 E4); unfold c in *; lra).
  pose proof (proj2 (eigen_deflated _ _ (-c) u3 u4 O34) E4) as C4.
  pose proof (proj2 (eigen_deflated _ _ (-c) u2 u4 O24) C4) as B4.
  pose proof (proj2 (eigen_deflated _ _ (-c) u1 u4 O14) B4) as A4.
  assert (k4 <= k3).
  { pose proof (M3 u4) as H1. rewrite (eigen_form _ k4 u4 U4 C4), U4 in H1. lra. }
  exists (choose k1 k2 k3 k4), (choose u1 u2 u3 u4). split.
  - intros i j; destruct i, j; simpl; try assumption; rewrite qdot_comm; assumption.
  - intros []; assumption.
  - repeat split; assumption.
Qed.

(** ** Parseval *)

(** q minus its components along the basis. *)
Definition rest (u : four -> quat) q :=
  qadd q (qscale (-1) (qadd (qadd (qscale (qdot q (u I1)) (u I1)) (qscale (qdot q (u I2)) (u I2)))
                            (qadd (qscale (qdot q (u I3)) (u I3)) (qscale (qdot q (u I4)) (u I4))))).

Lemma rest_norm u q : orthonormal u ->
  qnorm2 (rest u q) = qnorm2 q - sum4 (fun i => qdot q (u i) * qdot q (u i)).
Proof.
  intro O. unfold rest, qnorm2, sum4.
  rewrite !qdot_add, !qdot_scale, !qdot_add, !qdot_scale.
  rewrite !qdot_add_right, !qdot_scale_right, !qdot_add_right, !qdot_scale_right.
  rewrite !(qdot_comm (u I1) q), !(qdot_comm (u I2) q), !(qdot_comm (u I3) q), !(qdot_comm (u I4) q).
  rewrite !O. simpl. ring.
Qed.

Lemma rest_zero u : orthonormal u ->
  rest u e1 = qzero /\ rest u e2 = qzero /\ rest u e3 = qzero /\ rest u e4 = qzero.
Proof.
  intro O.
  pose proof (rest_norm u e1 O) as R1. pose proof (rest_norm u e2 O) as R2.
  pose proof (rest_norm u e3 O) as R3. pose proof (rest_norm u e4 O) as R4.
  pose proof (qnorm2_nonnegative (rest u e1)). pose proof (qnorm2_nonnegative (rest u e2)).
  pose proof (qnorm2_nonnegative (rest u e3)). pose proof (qnorm2_nonnegative (rest u e4)).
  assert (qnorm2 (rest u e1) + qnorm2 (rest u e2) + qnorm2 (rest u e3) + qnorm2 (rest u e4) = 0).
  { rewrite R1, R2, R3, R4.
    pose proof (O I1 I1) as N1. pose proof (O I2 I2) as N2.
    pose proof (O I3 I3) as N3. pose proof (O I4 I4) as N4. simpl in *.
    unfold sum4, e1, e2, e3, e4, qnorm2, qdot in *. simpl in *. lra. }
  repeat split; apply qnorm2_zero; lra.
Qed.

(** Parseval: the product of two vectors from their components. *)
Theorem parseval u p q : orthonormal u ->
  sum4 (fun i => qdot p (u i) * qdot q (u i)) = qdot p q.
Proof.
  intro O. destruct (rest_zero u O) as (Z1 & Z2 & Z3 & Z4).
  unfold rest, sum4, e1, e2, e3, e4, qadd, qscale, qdot, qzero in *. simpl in *.
  injection Z1 as A1 A2 A3 A4. injection Z2 as B1 B2 B3 B4.
  injection Z3 as C1 C2 C3 C4. injection Z4 as D1 D2 D3 D4.
  destruct (u I1) as [a1 b1 c1 d1], (u I2) as [a2 b2 c2 d2].
  destruct (u I3) as [a3 b3 c3 d3], (u I4) as [a4 b4 c4 d4].
  destruct p as [p1 p2 p3 p4], q as [q1 q2 q3 q4]. simpl in *.
  replace (_ + _ + _ + _) with
    (p1 * q1 * (a1*a1 + a2*a2 + a3*a3 + a4*a4) + p2 * q2 * (b1*b1 + b2*b2 + b3*b3 + b4*b4)
     + p3 * q3 * (c1*c1 + c2*c2 + c3*c3 + c4*c4) + p4 * q4 * (d1*d1 + d2*d2 + d3*d3 + d4*d4)
     + (p1 * q2 + p2 * q1) * (a1*b1 + a2*b2 + a3*b3 + a4*b4)
     + (p1 * q3 + p3 * q1) * (a1*c1 + a2*c2 + a3*c3 + a4*c4)
     + (p1 * q4 + p4 * q1) * (a1*d1 + a2*d2 + a3*d3 + a4*d4)
     + (p2 * q3 + p3 * q2) * (b1*c1 + b2*c2 + b3*c3 + b4*c4)
     + (p2 * q4 + p4 * q2) * (b1*d1 + b2*d2 + b3*d3 + b4*d4)
     + (p3 * q4 + p4 * q3) * (c1*d1 + c2*d2 + c3*d3 + c4*d4)) by ring.
  replace (a1*a1 + a2*a2 + a3*a3 + a4*a4) with 1 by lra.
  replace (b1*b1 + b2*b2 + b3*b3 + b4*b4) with 1 by lra.
  replace (c1*c1 + c2*c2 + c3*c3 + c4*c4) with 1 by lra.
  replace (d1*d1 + d2*d2 + d3*d3 + d4*d4) with 1 by lra.
  replace (a1*b1 + a2*b2 + a3*b3 + a4*b4) with 0 by lra.
  replace (a1*c1 + a2*c2 + a3*c3 + a4*c4) with 0 by lra.
  replace (a1*d1 + a2*d2 + a3*d3 + a4*d4) with 0 by lra.
  replace (b1*c1 + b2*c2 + b3*c3 + b4*c4) with 0 by lra.
  replace (b1*d1 + b2*d2 + b3*d3 + b4*d4) with 0 by lra.
  replace (c1*d1 + c2*d2 + c3*d3 + c4*d4) with 0 by lra.
  ring.
Qed.

Lemma norm_expansion u q : orthonormal u ->
  qnorm2 q = sum4 (fun i => qdot q (u i) * qdot q (u i)).
Proof. intro O. symmetry. apply parseval, O. Qed.

Lemma orthogonal_to_all_is_zero u q : orthonormal u -> (forall i, qdot q (u i) = 0) -> q = qzero.
Proof.
  intros O H. apply qnorm2_zero. rewrite (norm_expansion u q O). unfold sum4. rewrite !H. ring.
Qed.

Lemma apply_component A k u q i : spectral A k u ->
  qdot (apply A q) (u i) = k i * qdot q (u i).
Proof.
  intros [O E _]. rewrite qdot_comm, apply_symmetric, (E i), qdot_scale_right. reflexivity.
Qed.

(** q^T A q = sum k_i (q . u_i)^2. *)
Theorem form_expansion A k u q : spectral A k u ->
  form A q = sum4 (fun i => k i * (qdot q (u i) * qdot q (u i))).
Proof.
  intro S. unfold form. rewrite <- (parseval u q (apply A q) (basis _ _ _ S)).
  unfold sum4. rewrite !(apply_component A k u q _ S). ring.
Qed.

(** q^T A q is at most the largest eigenvalue times |q|^2. *)
Theorem largest_value A k u q : spectral A k u -> form A q <= k I1 * qnorm2 q.
Proof.
  intro S. rewrite (form_expansion A k u q S), (norm_expansion u q (basis _ _ _ S)).
  destruct (order _ _ _ S) as (D1 & D2 & D3). unfold sum4.
  assert (H : forall i, k i <= k I1 -> k i * (qdot q (u i) * qdot q (u i)) <=
              k I1 * (qdot q (u i) * qdot q (u i))).
  { intros i Hi. apply Rmult_le_compat_r; [nra | assumption]. }
  pose proof (H I2). pose proof (H I3). pose proof (H I4). lra.
Qed.

Lemma eigenvector_components A k u l q i : spectral A k u -> eigen A l q ->
  l = k i \/ qdot q (u i) = 0.
Proof.
  intros S E. pose proof (apply_component A k u q i S) as H. rewrite E, qdot_scale in H.
  assert (Z : (l - k i) * qdot q (u i) = 0) by lra.
  apply Rmult_integral in Z. destruct Z; [left; lra | right; assumption].
Qed.

(** There are no eigenvalues but those of the basis. *)
Theorem every_eigenvalue_is_listed A k u l q : spectral A k u -> eigen A l q -> q <> qzero ->
  exists i, l = k i.
Proof.
  intros S E H.
  destruct (eigenvector_components A k u l q I1 S E); [exists I1; auto|].
  destruct (eigenvector_components A k u l q I2 S E); [exists I2; auto|].
  destruct (eigenvector_components A k u l q I3 S E); [exists I3; auto|].
  destruct (eigenvector_components A k u l q I4 S E); [exists I4; auto|].
  exfalso. apply H, (orthogonal_to_all_is_zero u q (basis _ _ _ S)). intros []; assumption.
Qed.

Lemma basis_unit A k u i : spectral A k u -> unit (u i).
Proof. intros [O _ _]. unfold unit, qnorm2. rewrite O. destruct i; reflexivity. Qed.

(** A unit eigenvector of a simple eigenvalue is, up to sign, the one in the basis. *)
Theorem simple_eigenvector A k u i q : spectral A k u -> (forall j, j <> i -> k j <> k i) ->
  unit q -> eigen A (k i) q -> q = u i \/ q = qscale (-1) (u i).
Proof.
  intros S simple Hq E.
  assert (Z : forall j, j <> i -> qdot q (u j) = 0).
  { intros j Hj. destruct (eigenvector_components A k u (k i) q j S E) as [H | H]; auto.
    exfalso. apply (simple j Hj). auto. }
  assert (N : qdot q (u i) * qdot q (u i) = 1).
  { rewrite <- Hq, (norm_expansion u q (basis _ _ _ S)). unfold sum4.
    destruct i; rewrite ?(Z I1), ?(Z I2), ?(Z I3), ?(Z I4) by congruence; ring. }
  assert (D : (qdot q (u i) - 1) * (qdot q (u i) + 1) = 0) by lra.
  apply Rmult_integral in D. destruct D.
  - left. apply unit_dot_one; [assumption | apply (basis_unit A k u i S) | lra].
  - right. apply unit_dot_one; [assumption | | rewrite qdot_scale_right; lra].
    unfold unit, qnorm2. rewrite qdot_scale, qdot_scale_right. fold (qnorm2 (u i)).
    rewrite (basis_unit A k u i S). ring.
Qed.

(** ** Power sums of the eigenvalues, from the entries *)

Definition twice A q := apply A (apply A q).

(** The trace is the sum of the eigenvalues. *)
Theorem sum_of_eigenvalues A k u : spectral A k u -> sum4 k = strace A.
Proof.
  intro S.
  transitivity (form A e1 + form A e2 + form A e3 + form A e4); [|unfold e1, e2, e3, e4; by_forms].
  rewrite !(form_expansion A k u _ S).
  assert (N : forall i, qdot e1 (u i) * qdot e1 (u i) + qdot e2 (u i) * qdot e2 (u i)
      + qdot e3 (u i) * qdot e3 (u i) + qdot e4 (u i) * qdot e4 (u i) = 1).
  { intro i. rewrite <- (basis_unit A k u i S). unfold e1, e2, e3, e4.
    destruct (u i). unfold_quats. ring. }
  unfold sum4.
  transitivity (sum4 (fun i => k i * (qdot e1 (u i) * qdot e1 (u i) + qdot e2 (u i) * qdot e2 (u i)
      + qdot e3 (u i) * qdot e3 (u i) + qdot e4 (u i) * qdot e4 (u i)))).
  - unfold sum4. rewrite !N. ring.
  - unfold sum4. ring.
Qed.

(** sum over the basis of (P q) . (Q q) for maps with (P q) . u_i = f_i (q . u_i). *)
Lemma sum_of_products (u : four -> quat) (P Q : quat -> quat) f g : orthonormal u ->
  (forall q i, qdot (P q) (u i) = f i * qdot q (u i)) ->
  (forall q i, qdot (Q q) (u i) = g i * qdot q (u i)) ->
  qdot (P e1) (Q e1) + qdot (P e2) (Q e2) + qdot (P e3) (Q e3) + qdot (P e4) (Q e4) =
  sum4 (fun i => f i * g i).
Proof.
  intros O HP HQ. rewrite <- !(parseval u _ _ O). unfold sum4. rewrite !HP, !HQ.
  assert (N : forall i, qdot e1 (u i) * qdot e1 (u i) + qdot e2 (u i) * qdot e2 (u i)
      + qdot e3 (u i) * qdot e3 (u i) + qdot e4 (u i) * qdot e4 (u i) = 1).
  { intro i. transitivity (qdot (u i) (u i)); [|rewrite O; destruct i; reflexivity].
    unfold e1, e2, e3, e4. destruct (u i). unfold_quats. ring. }
  transitivity (sum4 (fun i => f i * g i * (qdot e1 (u i) * qdot e1 (u i)
      + qdot e2 (u i) * qdot e2 (u i) + qdot e3 (u i) * qdot e3 (u i)
      + qdot e4 (u i) * qdot e4 (u i)))).
  - unfold sum4. ring.
  - unfold sum4. rewrite !N. ring.
Qed.
