(** Positive definiteness, decided by elimination without division.

    Claimed: a symmetric matrix with first row (a, b^T) is positive definite just where a > 0 and
    a D - b b^T is; so 4x4 and 3x3 forms are decided by products and differences. *)

Require Import Reals Lra ZArith Bool.
From Certreg Require Import Vectors Quaternions Davenport Certificate.
Open Scope R_scope.

Definition positive2 a b c := 0 < a /\ 0 < a * c - b * b.
Definition positive3 a b c d e f :=
  0 < a /\ positive2 (a * d - b * b) (a * e - b * c) (a * f - c * c).
Definition positive4 A :=
  let '(Sym a b c d e f g h i j) := A in
  0 < a /\ positive3 (a * e - b * b) (a * f - b * c) (a * g - b * d) (a * h - c * c) (a * i - c * d)
                     (a * j - d * d).

Definition form2 a b c x y := a * (x * x) + 2 * b * (x * y) + c * (y * y).
Definition form3 a b c d e f x y z :=
  a * (x * x) + 2 * b * (x * y) + 2 * c * (x * z) + form2 d e f y z.

Lemma positive2_iff a b c :
  positive2 a b c <-> forall x y, x <> 0 \/ y <> 0 -> 0 < form2 a b c x y.
Proof.
  unfold positive2, form2. split.
  - intros [A D] x y H.
    assert (E : a * (a * (x * x) + 2 * b * (x * y) + c * (y * y)) =
                (a * x + b * y) * (a * x + b * y) + (a * c - b * b) * (y * y)) by ring.
    assert (P : 0 < (a * x + b * y) * (a * x + b * y) + (a * c - b * b) * (y * y)).
    { destruct (Req_dec y 0) as [-> | Y].
      - assert (x <> 0) by tauto. assert (0 < (a * x) * (a * x)) by (apply Rsqr_pos_lt; nra). nra.
      - assert (0 < y * y) by (apply Rsqr_pos_lt; assumption).
        pose proof (Rle_0_sqr (a * x + b * y)) as Q. unfold Rsqr in Q. nra. }
    rewrite <- E in P. nra.
  - intro H. pose proof (H 1 0 (or_introl R1_neq_R0)) as A. assert (A' : 0 < a) by lra.
    split; [assumption|].
    assert (N : - b <> 0 \/ a <> 0) by (right; lra).
    specialize (H (- b) a N).
    replace (a * (- b * - b) + 2 * b * (- b * a) + c * (a * a)) with (a * (a * c - b * b)) in H by ring.
    nra.
Qed.

Lemma positive3_iff a b c d e f :
  positive3 a b c d e f <->
  forall x y z, x <> 0 \/ y <> 0 \/ z <> 0 -> 0 < form3 a b c d e f x y z.
Proof.
  unfold positive3. rewrite positive2_iff. unfold form3. split.
  - intros [A D] x y z H.
    assert (E : a * (a * (x * x) + 2 * b * (x * y) + 2 * c * (x * z) + form2 d e f y z) =
                (a * x + b * y + c * z) * (a * x + b * y + c * z)
                + form2 (a * d - b * b) (a * e - b * c) (a * f - c * c) y z)
      by (unfold form2; ring).
    pose proof (Rle_0_sqr (a * x + b * y + c * z)) as Q. unfold Rsqr in Q.
    assert (P : 0 < (a * x + b * y + c * z) * (a * x + b * y + c * z)
                + form2 (a * d - b * b) (a * e - b * c) (a * f - c * c) y z).
    { destruct (Req_dec y 0) as [Y | Y].
      - destruct (Req_dec z 0) as [Z | Z].
        + subst. assert (x <> 0) by tauto.
          assert (0 < (a * x) * (a * x)) by (apply Rsqr_pos_lt; nra). unfold form2. lra.
        + specialize (D y z (or_intror Z)). lra.
      - specialize (D y z (or_introl Y)). lra. }
    rewrite <- E in P. nra.
  - intro H. pose proof (H 1 0 0 (or_introl R1_neq_R0)) as A. unfold form2 in A.
    assert (A' : 0 < a) by lra. split; [assumption|].
    intros y z N.
    assert (N' : - (b * y + c * z) / a <> 0 \/ y <> 0 \/ z <> 0) by tauto.
    specialize (H _ _ _ N'). unfold form2 in *.
    replace ((a * d - b * b) * (y * y) + 2 * (a * e - b * c) * (y * z) + (a * f - c * c) * (z * z))
      with (a * (a * (- (b * y + c * z) / a * (- (b * y + c * z) / a))
                 + 2 * b * (- (b * y + c * z) / a * y) + 2 * c * (- (b * y + c * z) / a * z)
                 + (d * (y * y) + 2 * e * (y * z) + f * (z * z)))) by (field; lra).
    nra.
Qed.

(** A 4x4 form is positive just where four numbers are, found without division. *)
Theorem positive4_iff A : positive4 A <-> form_positive A.
Proof.
  destruct A as [a b c d e f g h i j]. unfold positive4. rewrite positive3_iff.
  unfold form_positive. split.
  - intros [A D] [w x y z] H.
    assert (E : a * form (Sym a b c d e f g h i j) (Quat w x y z) =
                (a * w + b * x + c * y + d * z) * (a * w + b * x + c * y + d * z)
                + form3 (a * e - b * b) (a * f - b * c) (a * g - b * d) (a * h - c * c)
                        (a * i - c * d) (a * j - d * d) x y z)
      by (clear; unfold form3, form2; unfold_forms; ring).
    pose proof (Rle_0_sqr (a * w + b * x + c * y + d * z)) as Q. unfold Rsqr in Q.
    assert (P : 0 < a * form (Sym a b c d e f g h i j) (Quat w x y z)).
    { rewrite E. destruct (Req_dec x 0) as [X | X].
      - destruct (Req_dec y 0) as [Y | Y].
        + destruct (Req_dec z 0) as [Z | Z].
          * subst. assert (w <> 0) by (intros ->; apply H; reflexivity).
            assert (0 < (a * w) * (a * w)) by (apply Rsqr_pos_lt; nra).
            unfold form3, form2. lra.
          * specialize (D x y z (or_intror (or_intror Z))). lra.
        + specialize (D x y z (or_intror (or_introl Y))). lra.
      - specialize (D x y z (or_introl X)). lra. }
    nra.
  - intro H.
    assert (A : 0 < a).
    { specialize (H (Quat 1 0 0 0)).
      replace (form (Sym a b c d e f g h i j) (Quat 1 0 0 0)) with a in H by (clear; by_forms).
      apply H. unfold qzero. intro E. injection E. lra. }
    split; [assumption|]. intros x y z N.
    specialize (H (Quat (- (b * x + c * y + d * z) / a) x y z)).
    assert (0 < form (Sym a b c d e f g h i j) (Quat (- (b * x + c * y + d * z) / a) x y z)).
    { apply H. unfold qzero. intro E. injection E as _ E1 E2 E3. tauto. }
    replace (form3 (a * e - b * b) (a * f - b * c) (a * g - b * d) (a * h - c * c)
               (a * i - c * d) (a * j - d * d) x y z)
      with (a * form (Sym a b c d e f g h i j) (Quat (- (b * x + c * y + d * z) / a) x y z))
      by (clear - A; unfold form3, form2; unfold_forms; field; lra).
    nra.
Qed.

(** The same for a symmetric 3x3 matrix. *)
Theorem positive3_definite A : symmetric A ->
  positive3 (m11 A) (m12 A) (m13 A) (m22 A) (m23 A) (m33 A) <-> positive_definite A.
Proof.
  intro S. rewrite positive3_iff. unfold positive_definite.
  assert (E : forall x y z, quadratic A (Vec x y z) =
    form3 (m11 A) (m12 A) (m13 A) (m22 A) (m23 A) (m33 A) x y z).
  { intros. unfold symmetric in S. destruct A. unfold transpose in S. simpl in S.
    injection S as S1 S2 S3 S4 S5 S6. subst. unfold form3, form2. unfold_vectors. ring. }
  split.
  - intros H [x y z] N. rewrite E. apply H.
    destruct (Req_dec x 0) as [-> |]; [|tauto]. destruct (Req_dec y 0) as [-> |]; [|tauto].
    right. right. intros ->. apply N. reflexivity.
  - intros H x y z N. rewrite <- E. apply H. unfold vzero. intro Z. injection Z. tauto.
Qed.
