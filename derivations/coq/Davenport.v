(** Davenport's matrix: the objective as a quadratic form in the quaternion.

    Claimed: q^T K q = tr(R(q)^T C) and the springs' torque 2 L(q)^T K q for every q; K q is a
    multiple of a unit q just where that torque vanishes. *)

Require Import Reals Lra.
From Certreg Require Import Vectors Quaternions.
Open Scope R_scope.

(** A symmetric 4x4 matrix by its entries on and above the diagonal. *)
Record sym := Sym { s00 : R; s01 : R; s02 : R; s03 : R; s11 : R; s12 : R; s13 : R;
                    s22 : R; s23 : R; s33 : R }.

Definition apply A q :=
  Quat (s00 A * qw q + s01 A * qx q + s02 A * qy q + s03 A * qz q)
       (s01 A * qw q + s11 A * qx q + s12 A * qy q + s13 A * qz q)
       (s02 A * qw q + s12 A * qx q + s22 A * qy q + s23 A * qz q)
       (s03 A * qw q + s13 A * qx q + s23 A * qy q + s33 A * qz q).
Definition form A q := qdot q (apply A q).
Definition strace A := s00 A + s11 A + s22 A + s33 A.

(** A + k p p^T, and A + k I. *)
Definition sadd_square k p A :=
  Sym (s00 A + k * (qw p * qw p)) (s01 A + k * (qw p * qx p)) (s02 A + k * (qw p * qy p))
      (s03 A + k * (qw p * qz p)) (s11 A + k * (qx p * qx p)) (s12 A + k * (qx p * qy p))
      (s13 A + k * (qx p * qz p)) (s22 A + k * (qy p * qy p)) (s23 A + k * (qy p * qz p))
      (s33 A + k * (qz p * qz p)).
Definition sshift k A :=
  Sym (s00 A + k) (s01 A) (s02 A) (s03 A) (s11 A + k) (s12 A) (s13 A) (s22 A + k) (s23 A)
      (s33 A + k).
Definition sscale k A :=
  Sym (k * s00 A) (k * s01 A) (k * s02 A) (k * s03 A) (k * s11 A) (k * s12 A) (k * s13 A)
      (k * s22 A) (k * s23 A) (k * s33 A).

(** K(C) = [[tr C, z^T], [z, C + C^T - tr(C) I]], z = vee(C - C^T). *)
Definition davenport C :=
  Sym (m11 C + m22 C + m33 C) (m32 C - m23 C) (m13 C - m31 C) (m21 C - m12 C)
      (m11 C - m22 C - m33 C) (m12 C + m21 C) (m13 C + m31 C)
      (m22 C - m11 C - m33 C) (m23 C + m32 C) (m33 C - m11 C - m22 C).

Definition eigen A k q := apply A q = qscale k q.

Ltac unfold_forms :=
  cbv beta iota zeta delta
    [eigen form apply strace sadd_square sshift sscale davenport
     s00 s01 s02 s03 s11 s12 s13 s22 s23 s33
     unit qnorm2 tangent cotangent qmul rot qdot qadd qscale qzero qw qx qy qz
     msub quadratic norm2 trace det adjugate transpose mmul mvec outer hat vee cross dot vsub vadd
     vscale madd mscale mid mzero vzero v1 v2 v3 m11 m12 m13 m21 m22 m23 m31 m32 m33] in *.
Ltac by_forms :=
  intros; open_quats; repeat match goal with A : sym |- _ => destruct A end;
  unfold_forms; entrywise ltac:(ring).

Lemma apply_add A p q : apply A (qadd p q) = qadd (apply A p) (apply A q).
Proof. by_forms. Qed.

Lemma apply_scale A k q : apply A (qscale k q) = qscale k (apply A q).
Proof. by_forms. Qed.

Lemma apply_symmetric A p q : qdot p (apply A q) = qdot q (apply A p).
Proof. by_forms. Qed.

Lemma apply_shift A k q : apply (sshift k A) q = qadd (apply A q) (qscale k q).
Proof. by_forms. Qed.

Lemma apply_square A k p q :
  apply (sadd_square k p A) q = qadd (apply A q) (qscale (k * qdot p q) p).
Proof. by_forms. Qed.

Lemma form_scale A k q : form A (qscale k q) = k * k * form A q.
Proof. by_forms. Qed.

Lemma form_shift A k q : form (sshift k A) q = form A q + k * qnorm2 q.
Proof. by_forms. Qed.

Lemma form_square A k p q : form (sadd_square k p A) q = form A q + k * (qdot p q * qdot p q).
Proof. by_forms. Qed.

Lemma form_sscale A k q : form (sscale k A) q = k * form A q.
Proof. by_forms. Qed.

Lemma eigen_form A k q : unit q -> eigen A k q -> form A q = k.
Proof. intros Hq H. unfold form. rewrite H, qdot_scale_right. fold (qnorm2 q). rewrite Hq. ring. Qed.

Lemma eigen_scale A k m q : eigen A k q -> eigen A k (qscale m q).
Proof. unfold eigen. intro H. rewrite apply_scale, H. by_entries. Qed.

(** q^T K q = tr(R(q)^T C), for every q. *)
Theorem davenport_form C q : form (davenport C) q = trace (mmul (transpose (rot q)) C).
Proof. by_forms. Qed.

(** tr K = 0. *)
Theorem davenport_traceless C : strace (davenport C) = 0.
Proof. by_forms. Qed.

(** vee(R^T C - C^T R) = L(q)^T K q; the torque of the springs is twice that. *)
Theorem davenport_torque C q :
  vee (msub (mmul (transpose (rot q)) C) (mmul (transpose C) (rot q))) =
  cotangent q (apply (davenport C) q).
Proof. by_forms. Qed.

Lemma cotangent_zero A q : unit q ->
  cotangent q (apply A q) = vzero <-> eigen A (form A q) q.
Proof.
  intro Hq. split; intro H.
  - pose proof (along_and_across q (apply A q)) as E. rewrite H, Hq in E.
    unfold eigen, form. revert E. generalize (apply A q). intros p E.
    transitivity (qscale 1 p); [clear; by_entries|]. rewrite E. clear. by_entries.
  - rewrite H. generalize (form A q). intros. by_entries.
Qed.

Lemma symmetric_vee (A : mat) : vee (msub A (transpose A)) = vzero <-> symmetric A.
Proof.
  destruct A; unfold symmetric; unfold_vectors; simpl. split; intro H; injection H; intros.
  - f_equal; lra.
  - f_equal; lra.
Qed.

(** R^T C is symmetric just where the quaternion of R is an eigenvector of K. *)
Theorem balanced_iff_eigenvector C q : unit q ->
  symmetric (mmul (transpose (rot q)) C) <-> eigen (davenport C) (form (davenport C) q) q.
Proof.
  intro Hq. rewrite <- symmetric_vee, transpose_mmul.
  replace (transpose (transpose (rot q))) with (rot q) by by_entries.
  rewrite davenport_torque. apply cotangent_zero, Hq.
Qed.
