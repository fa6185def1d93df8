(** Quaternions, seen as vectors of R^4, and the rotations that they stand for.

    Claimed: R(q) is a rotation for every unit q; every rotation is some R(q); R(p) = R(q) only for
    p = q and p = -q; orthogonal unit quaternions are rotations half a turn apart. *)

Require Import Reals Lra.
From Certreg Require Import Vectors.
Open Scope R_scope.

(** Scalar part first. *)
Record quat := Quat { qw : R; qx : R; qy : R; qz : R }.

Definition qzero := Quat 0 0 0 0.
Definition qadd p q := Quat (qw p + qw q) (qx p + qx q) (qy p + qy q) (qz p + qz q).
Definition qscale k q := Quat (k * qw q) (k * qx q) (k * qy q) (k * qz q).
Definition qdot p q := qw p * qw q + qx p * qx q + qy p * qy q + qz p * qz q.
Definition qnorm2 q := qdot q q.
Definition unit q := qnorm2 q = 1.
Definition qmul p q :=
  Quat (qw p * qw q - qx p * qx q - qy p * qy q - qz p * qz q)
       (qw p * qx q + qx p * qw q + qy p * qz q - qz p * qy q)
       (qw p * qy q - qx p * qz q + qy p * qw q + qz p * qx q)
       (qw p * qz q + qx p * qy q - qy p * qx q + qz p * qw q).

(** L(q) a = q (0, a), and its transpose: L^T L = |q|^2 I, L^T q = 0. *)
Definition tangent q a := qmul q (Quat 0 (v1 a) (v2 a) (v3 a)).
Definition cotangent q p :=
  Vec (- qx q * qw p + qw q * qx p + qz q * qy p - qy q * qz p)
      (- qy q * qw p - qz q * qx p + qw q * qy p + qx q * qz p)
      (- qz q * qw p + qy q * qx p - qx q * qy p + qw q * qz p).

Definition rot q :=
  let '(Quat w x y z) := q in
  Mat (w*w + x*x - y*y - z*z) (2 * (x*y - w*z)) (2 * (x*z + w*y))
      (2 * (x*y + w*z)) (w*w - x*x + y*y - z*z) (2 * (y*z - w*x))
      (2 * (x*z - w*y)) (2 * (y*z + w*x)) (w*w - x*x - y*y + z*z).

(** The angle between two rotations is 180 degrees: its cosine, (tr(P^T R) - 1) / 2, is -1. *)
Definition half_turn_apart P R := trace (mmul (transpose P) R) = -1.

Ltac open_quats :=
  repeat match goal with q : quat |- _ => destruct q end; open_vectors.
Ltac unfold_quats :=
  cbv beta iota zeta delta
    [unit qnorm2 tangent cotangent qmul rot qdot qadd qscale qzero qw qx qy qz
     msub quadratic norm2 trace det adjugate transpose mmul mvec outer hat vee cross dot vsub vadd
     vscale madd mscale mid mzero vzero v1 v2 v3 m11 m12 m13 m21 m22 m23 m31 m32 m33] in *.
Ltac by_entries := intros; open_quats; unfold_quats; entrywise ltac:(ring).

Lemma quat_eq_dec (p q : quat) : {p = q} + {p <> q}.
Proof.
  destruct p as [a b c d], q as [a' b' c' d'].
  destruct (Req_EM_T a a'); [subst | right; congruence].
  destruct (Req_EM_T b b'); [subst | right; congruence].
  destruct (Req_EM_T c c'); [subst | right; congruence].
  destruct (Req_EM_T d d'); [subst; now left | right; congruence].
Qed.

Lemma qdot_comm p q : qdot p q = qdot q p.
Proof. by_entries. Qed.

Lemma qdot_add p q r : qdot (qadd p q) r = qdot p r + qdot q r.
Proof. by_entries. Qed.

Lemma qdot_add_right p q r : qdot r (qadd p q) = qdot r p + qdot r q.
Proof. by_entries. Qed.

Lemma qdot_scale k p q : qdot (qscale k p) q = k * qdot p q.
Proof. by_entries. Qed.

Lemma qdot_scale_right k p q : qdot p (qscale k q) = k * qdot p q.
Proof. by_entries. Qed.

Lemma qnorm2_nonnegative q : 0 <= qnorm2 q.
Proof. destruct q; unfold qnorm2, qdot; simpl; nra. Qed.

Lemma qnorm2_zero q : qnorm2 q = 0 -> q = qzero.
Proof.
  destruct q as [w x y z]; unfold qnorm2, qdot, qzero; simpl; intro H.
  assert (w = 0) by nra. assert (x = 0) by nra. assert (y = 0) by nra. assert (z = 0) by nra.
  congruence.
Qed.

Lemma qnorm2_positive q : q <> qzero -> 0 < qnorm2 q.
Proof.
  intro H. destruct (Rle_lt_or_eq_dec _ _ (qnorm2_nonnegative q)); auto.
  exfalso; apply H, qnorm2_zero; congruence.
Qed.

Lemma unit_nonzero q : unit q -> q <> qzero.
Proof. intros H ->. unfold_quats; simpl in *. lra. Qed.

Lemma normalised q : q <> qzero -> unit (qscale (/ sqrt (qnorm2 q)) q).
Proof.
  intro H. apply qnorm2_positive in H.
  unfold unit, qnorm2. rewrite qdot_scale, qdot_scale_right. fold (qnorm2 q).
  assert (0 < sqrt (qnorm2 q)) by (apply sqrt_lt_R0; assumption).
  rewrite <- (sqrt_sqrt (qnorm2 q)) at 3 by lra. field. lra.
Qed.

(** L(q)^T L(q) = |q|^2 I. *)
Theorem cotangent_tangent q a : cotangent q (tangent q a) = vscale (qnorm2 q) a.
Proof. by_entries. Qed.

(** L(q)^T q = 0. *)
Theorem cotangent_self q : cotangent q q = vzero.
Proof. by_entries. Qed.

Lemma tangent_orthogonal q a : qdot q (tangent q a) = 0.
Proof. by_entries. Qed.

Lemma tangent_norm q a : qnorm2 (tangent q a) = qnorm2 q * norm2 a.
Proof. by_entries. Qed.

Lemma qdot_tangent q a p : qdot p (tangent q a) = dot (cotangent q p) a.
Proof. by_entries. Qed.

(** q q^T + L(q) L(q)^T = |q|^2 I: every quaternion splits along q and across it. *)
Theorem along_and_across q p :
  qscale (qnorm2 q) p = qadd (qscale (qdot q p) q) (tangent q (cotangent q p)).
Proof. by_entries. Qed.

Lemma dot_cotangent q p r :
  dot (cotangent q p) (cotangent q r) = qnorm2 q * qdot p r - qdot q p * qdot q r.
Proof. by_entries. Qed.

Lemma rot_opposite q : rot (qscale (-1) q) = rot q.
Proof. by_entries. Qed.

(** R(q)^T R(q) = |q|^4 I, for q of any length. *)
Theorem rot_orthogonal q : mmul (transpose (rot q)) (rot q) = mscale (qnorm2 q * qnorm2 q) mid.
Proof. by_entries. Qed.

(** det R(q) = |q|^6. *)
Theorem rot_det q : det (rot q) = qnorm2 q * qnorm2 q * qnorm2 q.
Proof. by_entries. Qed.

(** R(q) is a rotation for every unit quaternion. *)
Theorem unit_quaternions_rotate q : unit q -> rotation (rot q).
Proof.
  intro H. split.
  - rewrite rot_orthogonal, H. unfold mscale, mid; simpl; f_equal; ring.
  - rewrite rot_det, H. ring.
Qed.

Lemma trace_between q p :
  trace (mmul (transpose (rot p)) (rot q)) = 4 * (qdot p q * qdot p q) - qnorm2 p * qnorm2 q.
Proof. by_entries. Qed.

(** Orthogonal unit quaternions are rotations exactly 180 degrees apart. *)
Theorem orthogonal_quaternions_are_half_a_turn_apart p q :
  unit p -> unit q -> qdot p q = 0 -> half_turn_apart (rot p) (rot q).
Proof. intros Hp Hq H. unfold half_turn_apart. rewrite trace_between, Hp, Hq, H. ring. Qed.

(** And only those: half a turn apart means orthogonal. *)
Theorem half_turn_apart_iff_orthogonal p q :
  unit p -> unit q -> half_turn_apart (rot p) (rot q) <-> qdot p q = 0.
Proof. intros Hp Hq. unfold half_turn_apart. rewrite trace_between, Hp, Hq. split; nra. Qed.

Lemma half_turn_apart_differ P R : rotation P -> half_turn_apart P R -> P <> R.
Proof.
  intros [orthogonal _] H <-. unfold half_turn_apart in H. rewrite orthogonal in H.
  unfold trace, mid in H; simpl in H. lra.
Qed.

(** Unit vectors whose product is 1 are equal. *)
Lemma unit_dot_one p q : unit p -> unit q -> qdot p q = 1 -> p = q.
Proof.
  intros Hp Hq H.
  assert (Z : qadd p (qscale (-1) q) = qzero).
  { apply qnorm2_zero. unfold qnorm2.
    rewrite qdot_add, !qdot_add_right, !qdot_scale, !qdot_scale_right, (qdot_comm q p), H.
    fold (qnorm2 p) (qnorm2 q). rewrite Hp, Hq. ring. }
  destruct p, q. unfold qadd, qscale, qzero in Z. simpl in Z. injection Z as A B C D.
  f_equal; lra.
Qed.

(** R(p) = R(q) only for p = q and p = - q. *)
Theorem same_rotation_same_quaternion_up_to_sign p q :
  unit p -> unit q -> rot p = rot q -> p = q \/ p = qscale (-1) q.
Proof.
  intros Hp Hq H. pose proof (trace_between q p) as T.
  rewrite <- H, rot_orthogonal, Hp, Hq in T.
  unfold trace, mscale, mid in T; simpl in T.
  assert ((qdot p q - 1) * (qdot p q + 1) = 0) as Z by lra.
  apply Rmult_integral in Z. destruct Z.
  - left. apply unit_dot_one; auto; lra.
  - right. apply unit_dot_one; auto.
    + unfold unit, qnorm2. rewrite qdot_scale, qdot_scale_right. fold (qnorm2 q). rewrite Hq. ring.
    + rewrite qdot_scale_right. lra.
Qed.

(** ** Every rotation has a quaternion

    4 q q^T is linear in R; with [k] entries of that matrix, a column of it is 2 sqrt(k) q. *)

Definition outer_products_of (R : mat) (q : quat) :=
  4 * (qw q * qw q) = 1 + m11 R + m22 R + m33 R /\
  4 * (qx q * qx q) = 1 + m11 R - m22 R - m33 R /\
  4 * (qy q * qy q) = 1 - m11 R + m22 R - m33 R /\
  4 * (qz q * qz q) = 1 - m11 R - m22 R + m33 R /\
  4 * (qw q * qx q) = m32 R - m23 R /\ 4 * (qw q * qy q) = m13 R - m31 R /\
  4 * (qw q * qz q) = m21 R - m12 R /\ 4 * (qx q * qy q) = m12 R + m21 R /\
  4 * (qx q * qz q) = m13 R + m31 R /\ 4 * (qy q * qz q) = m23 R + m32 R.

Lemma outer_products_give_rotation R q : outer_products_of R q -> unit q /\ rot q = R.
Proof.
  destruct q, R. unfold outer_products_of, unit, qnorm2, qdot, rot; simpl.
  intros H. decompose [and] H. split; [lra | f_equal; lra].
Qed.

Lemma divided_products a b k l s : s * s = k -> 0 < s -> k * l = a * b ->
  4 * ((a / (2 * s)) * (b / (2 * s))) = l.
Proof.
  intros Hs Ps H. assert (0 < k) by nra.
  replace (4 * (a / (2 * s) * (b / (2 * s)))) with ((a * b) / (s * s)) by (field; lra).
  rewrite Hs, <- H. field. lra.
Qed.

(** The relations between the entries of a rotation: lengths, right angles, cofactors. *)
Lemma rotation_entries R : rotation R ->
  mmul (transpose R) R = mid /\ mmul R (transpose R) = mid /\ transpose R = adjugate R.
Proof.
  intro H. split; [apply H | split; [apply rotation_transpose | apply rotation_adjugate]]; auto.
Qed.

Ltac column k a b c d :=
  let s := fresh "s" in
  set (s := sqrt k);
  assert (s * s = k) by (apply sqrt_sqrt; lra);
  assert (0 < s) by (apply sqrt_lt_R0; lra);
  exists (Quat (a / (2 * s)) (b / (2 * s)) (c / (2 * s)) (d / (2 * s)));
  apply outer_products_give_rotation; unfold outer_products_of; simpl;
  repeat apply conj; (apply (divided_products _ _ k); [assumption | assumption | lra]).

(** Every rotation, R^T R = I and det R = 1, is R(q) for a unit quaternion. *)
Theorem every_rotation_has_a_quaternion R : rotation R -> exists q, unit q /\ rot q = R.
Proof.
  intro rotates. destruct (rotation_entries R rotates) as (columns & rows & cofactors).
  destruct R as [a b c d e f g h i].
  unfold mmul, transpose, adjugate, mid in *; simpl in *.
  injection columns; injection rows; injection cofactors; intros.
  clear columns rows cofactors rotates.
  destruct (Rlt_dec 0 (1 + a + e + i)).
  { column (1 + a + e + i) (1 + a + e + i) (h - f) (c - g) (d - b). }
  destruct (Rlt_dec 0 (1 + a - e - i)).
  { column (1 + a - e - i) (h - f) (1 + a - e - i) (b + d) (c + g). }
  destruct (Rlt_dec 0 (1 - a + e - i)).
  { column (1 - a + e - i) (c - g) (b + d) (1 - a + e - i) (f + h). }
  destruct (Rlt_dec 0 (1 - a - e + i)).
  { column (1 - a - e + i) (d - b) (c + g) (f + h) (1 - a - e + i). }
  exfalso; lra.
Qed.
