(** Vectors and matrices of space, and rotations.

    Claimed: the identities of the cross product, and that a rotation (R^T R = I, det R = 1) has
    R R^T = I and keeps lengths.
    Everything is written in components, so that an identity is one call of [ring]. *)

Require Import Reals Lra.
Open Scope R_scope.

Record vec := Vec { v1 : R; v2 : R; v3 : R }.

(** Row by row: [m12] stands in the first row and the second column. *)
Record mat := Mat { m11 : R; m12 : R; m13 : R;
                    m21 : R; m22 : R; m23 : R;
                    m31 : R; m32 : R; m33 : R }.

Definition vzero := Vec 0 0 0.
Definition vadd a b := Vec (v1 a + v1 b) (v2 a + v2 b) (v3 a + v3 b).
Definition vscale k a := Vec (k * v1 a) (k * v2 a) (k * v3 a).
Definition vsub a b := Vec (v1 a - v1 b) (v2 a - v2 b) (v3 a - v3 b).
Definition dot a b := v1 a * v1 b + v2 a * v2 b + v3 a * v3 b.
Definition norm2 a := dot a a.
Definition cross a b :=
  Vec (v2 a * v3 b - v3 a * v2 b) (v3 a * v1 b - v1 a * v3 b) (v1 a * v2 b - v2 a * v1 b).

Definition mzero := Mat 0 0 0 0 0 0 0 0 0.
Definition mid := Mat 1 0 0 0 1 0 0 0 1.
Definition madd A B :=
  Mat (m11 A + m11 B) (m12 A + m12 B) (m13 A + m13 B)
      (m21 A + m21 B) (m22 A + m22 B) (m23 A + m23 B)
      (m31 A + m31 B) (m32 A + m32 B) (m33 A + m33 B).
Definition mscale k A :=
  Mat (k * m11 A) (k * m12 A) (k * m13 A)
      (k * m21 A) (k * m22 A) (k * m23 A)
      (k * m31 A) (k * m32 A) (k * m33 A).
Definition msub A B := madd A (mscale (-1) B).
Definition transpose A :=
  Mat (m11 A) (m21 A) (m31 A) (m12 A) (m22 A) (m32 A) (m13 A) (m23 A) (m33 A).
Definition mmul A B :=
  Mat (m11 A * m11 B + m12 A * m21 B + m13 A * m31 B)
      (m11 A * m12 B + m12 A * m22 B + m13 A * m32 B)
      (m11 A * m13 B + m12 A * m23 B + m13 A * m33 B)
      (m21 A * m11 B + m22 A * m21 B + m23 A * m31 B)
      (m21 A * m12 B + m22 A * m22 B + m23 A * m32 B)
      (m21 A * m13 B + m22 A * m23 B + m23 A * m33 B)
      (m31 A * m11 B + m32 A * m21 B + m33 A * m31 B)
      (m31 A * m12 B + m32 A * m22 B + m33 A * m32 B)
      (m31 A * m13 B + m32 A * m23 B + m33 A * m33 B).
Definition mvec A a :=
  Vec (m11 A * v1 a + m12 A * v2 a + m13 A * v3 a)
      (m21 A * v1 a + m22 A * v2 a + m23 A * v3 a)
      (m31 A * v1 a + m32 A * v2 a + m33 A * v3 a).
Definition outer a b :=
  Mat (v1 a * v1 b) (v1 a * v2 b) (v1 a * v3 b)
      (v2 a * v1 b) (v2 a * v2 b) (v2 a * v3 b)
      (v3 a * v1 b) (v3 a * v2 b) (v3 a * v3 b).
Definition trace A := m11 A + m22 A + m33 A.
Definition det A :=
  m11 A * (m22 A * m33 A - m23 A * m32 A)
  - m12 A * (m21 A * m33 A - m23 A * m31 A)
  + m13 A * (m21 A * m32 A - m22 A * m31 A).
Definition adjugate A :=
  Mat (m22 A * m33 A - m23 A * m32 A) (m13 A * m32 A - m12 A * m33 A)
      (m12 A * m23 A - m13 A * m22 A)
      (m23 A * m31 A - m21 A * m33 A) (m11 A * m33 A - m13 A * m31 A)
      (m13 A * m21 A - m11 A * m23 A)
      (m21 A * m32 A - m22 A * m31 A) (m12 A * m31 A - m11 A * m32 A)
      (m11 A * m22 A - m12 A * m21 A).

(** The paper's [a]_x, with [a]_x b = a x b, and its inverse on skew matrices. *)
Definition hat a := Mat 0 (- v3 a) (v2 a) (v3 a) 0 (- v1 a) (- v2 a) (v1 a) 0.
Definition vee A := Vec (m32 A) (m13 A) (m21 A).

Definition quadratic A a := dot a (mvec A a).
Definition symmetric A := transpose A = A.
Definition positive_definite A := forall a, a <> vzero -> 0 < quadratic A a.
Definition rotation R := mmul (transpose R) R = mid /\ det R = 1.

(** Splits vectors and matrices into their entries and lets [ring] decide each of them. *)
(** [f_equal] on vectors and matrices only: on numbers it would take sums apart. *)
Ltac entrywise tactic :=
  match goal with
  | |- @eq R _ _ => tactic
  | |- _ => f_equal; tactic
  end.
Ltac open_vectors :=
  repeat match goal with
         | a : vec |- _ => destruct a
         | A : mat |- _ => destruct A
         end.
(** In one pass: unfolding step by step would copy what stands inside. *)
Ltac unfold_vectors :=
  cbv beta iota zeta delta
    [msub quadratic norm2 trace det adjugate transpose mmul mvec outer hat vee cross dot vsub vadd
     vscale madd mscale mid mzero vzero v1 v2 v3 m11 m12 m13 m21 m22 m23 m31 m32 m33] in *.
Ltac by_components := intros; open_vectors; unfold_vectors; entrywise ltac:(ring).

Lemma vec_eq a b : v1 a = v1 b -> v2 a = v2 b -> v3 a = v3 b -> a = b.
Proof. destruct a, b; simpl; intros; subst; reflexivity. Qed.

Lemma vec_eq_dec (a b : vec) : {a = b} + {a <> b}.
Proof.
  destruct a as [a1 a2 a3], b as [b1 b2 b3].
  destruct (Req_EM_T a1 b1); [subst | right; congruence].
  destruct (Req_EM_T a2 b2); [subst | right; congruence].
  destruct (Req_EM_T a3 b3); [subst; now left | right; congruence].
Qed.

Lemma mat_eq_dec (A B : mat) : {A = B} + {A <> B}.
Proof.
  destruct A as [a b c d e f g h i], B as [a' b' c' d' e' f' g' h' i'].
  destruct (Req_EM_T a a'); [subst | right; congruence].
  destruct (Req_EM_T b b'); [subst | right; congruence].
  destruct (Req_EM_T c c'); [subst | right; congruence].
  destruct (Req_EM_T d d'); [subst | right; congruence].
  destruct (Req_EM_T e e'); [subst | right; congruence].
  destruct (Req_EM_T f f'); [subst | right; congruence].
  destruct (Req_EM_T g g'); [subst | right; congruence].
  destruct (Req_EM_T h h'); [subst | right; congruence].
  destruct (Req_EM_T i i'); [subst; now left | right; congruence].
Qed.

Lemma norm2_nonnegative a : 0 <= norm2 a.
Proof. destruct a; unfold norm2, dot; simpl; nra. Qed.

Lemma norm2_zero a : norm2 a = 0 -> a = vzero.
Proof.
  destruct a as [x y z]; unfold norm2, dot, vzero; simpl; intro H.
  assert (x = 0) by nra. assert (y = 0) by nra. assert (z = 0) by nra. congruence.
Qed.

Lemma norm2_positive a : a <> vzero -> 0 < norm2 a.
Proof.
  intro H. destruct (Rle_lt_or_eq_dec _ _ (norm2_nonnegative a)); auto.
  exfalso; apply H, norm2_zero; congruence.
Qed.

Lemma scale_zero k a : k <> 0 -> vscale k a = vzero -> a = vzero.
Proof.
  intros Hk H. destruct a as [x y z]. unfold vscale, vzero in *. simpl in H.
  injection H as A B D. apply Rmult_integral in A. apply Rmult_integral in B.
  apply Rmult_integral in D. f_equal; tauto.
Qed.

Lemma cross_is_hat a b : cross a b = mvec (hat a) b.
Proof. by_components. Qed.

Lemma vee_hat a : vee (hat a) = a.
Proof. by_components. Qed.

Lemma mmul_assoc A B D : mmul A (mmul B D) = mmul (mmul A B) D.
Proof. by_components. Qed.

Lemma mmul_id_left A : mmul mid A = A.
Proof. by_components. Qed.

Lemma mmul_id_right A : mmul A mid = A.
Proof. by_components. Qed.

Lemma mvec_mmul A B a : mvec (mmul A B) a = mvec A (mvec B a).
Proof. by_components. Qed.

Lemma mvec_id a : mvec mid a = a.
Proof. by_components. Qed.

Lemma transpose_mmul A B : transpose (mmul A B) = mmul (transpose B) (transpose A).
Proof. by_components. Qed.

Lemma dot_mvec A a b : dot a (mvec A b) = dot (mvec (transpose A) a) b.
Proof. by_components. Qed.

Lemma det_mmul A B : det (mmul A B) = det A * det B.
Proof. by_components. Qed.

Lemma mmul_adjugate A : mmul A (adjugate A) = mscale (det A) mid.
Proof. by_components. Qed.

Lemma adjugate_mmul A : mmul (adjugate A) A = mscale (det A) mid.
Proof. by_components. Qed.

Lemma rotation_id : rotation mid.
Proof. split; unfold_vectors; simpl; [f_equal|]; ring. Qed.

(** A rotation is its own cofactor matrix. *)
Lemma rotation_adjugate R : rotation R -> transpose R = adjugate R.
Proof.
  intros [orthogonal unit_det].
  assert (inverse : mmul R (adjugate R) = mid)
    by (rewrite mmul_adjugate, unit_det; unfold mscale, mid; simpl; f_equal; ring).
  rewrite <- (mmul_id_right (transpose R)), <- inverse, mmul_assoc, orthogonal.
  apply mmul_id_left.
Qed.

(** R R^T = I for every rotation: the columns are orthonormal, too. *)
Theorem rotation_transpose R : rotation R -> mmul R (transpose R) = mid.
Proof.
  intro rotates. rewrite (rotation_adjugate R rotates), mmul_adjugate.
  destruct rotates as [_ ->]. unfold mscale, mid; simpl; f_equal; ring.
Qed.

(** |R a| = |a|. *)
Theorem rotation_keeps_lengths R a : rotation R -> norm2 (mvec R a) = norm2 a.
Proof.
  intros [orthogonal _]. unfold norm2.
  rewrite dot_mvec, <- mvec_mmul, orthogonal, mvec_id. reflexivity.
Qed.
