(** The index of a quadratic form on space, and two forms diagonalised together.

    Claimed: the index (how many squares carry a negative sign) does not depend on how the form is
    written (Sylvester); a symmetric matrix is diagonal in an orthonormal basis; with J positive
    definite, B^T J B = I and B^T G B = diag g for one invertible B. *)

Require Import Reals Lra List Lia.
From Coquelicot Require Import Rcomplements.
From Certreg Require Import Vectors Quaternions Davenport Extremum Spectral.
Open Scope R_scope.

(** ** Sylvester's law of inertia *)

Fixpoint squares (L : list (vec * R)) a :=
  match L with nil => 0 | (c, g) :: L => g * (dot c a * dot c a) + squares L a end.

(** a^T A a = g1 (c1 . a)^2 + g2 (c2 . a)^2 + g3 (c3 . a)^2 with independent c1, c2, c3. *)
Definition diagonalised A (L : list (vec * R)) :=
  length L = 3%nat /\
  (forall a, (forall p, In p L -> dot (fst p) a = 0) -> a = vzero) /\
  forall a, quadratic A a = squares L a.

Definition is_negative (p : vec * R) := if Rlt_dec (snd p) 0 then true else false.
Definition negatives L := length (filter is_negative L).
Definition index A (n : nat) := exists L, diagonalised A L /\ negatives L = n.

Lemma one_equation a : exists b, b <> vzero /\ dot a b = 0.
Proof.
  destruct (vec_eq_dec a (Vec 0 0 (v3 a))) as [E | E].
  - exists (Vec 1 0 0). split; [unfold vzero; intro H; injection H; lra|].
    rewrite E. unfold dot; simpl. ring.
  - exists (Vec (v2 a) (- v1 a) 0). destruct a as [x y z]. split.
    + intro H. apply E. unfold vzero in H. simpl in *. injection H as H1 H2. f_equal; lra.
    + unfold dot; simpl. ring.
Qed.

Lemma two_equations a b : exists d, d <> vzero /\ dot a d = 0 /\ dot b d = 0.
Proof.
  destruct (vec_eq_dec (cross a b) vzero) as [E | E].
  - destruct (vec_eq_dec a vzero) as [-> | Ha].
    + destruct (one_equation b) as (d & Hd & H). exists d. repeat split; auto. by_components.
    + destruct (one_equation a) as (d & Hd & H). exists d. repeat split; auto.
      assert (N : norm2 a * dot b d = 0).
      { replace (norm2 a * dot b d) with (dot (cross a b) (cross a d) + dot b a * dot a d)
          by (clear; by_components).
        rewrite E, H. replace (dot vzero (cross a d)) with 0 by (clear; by_components). ring. }
      apply norm2_positive in Ha. apply Rmult_integral in N. destruct N; [lra | assumption].
  - exists (cross a b). repeat split; auto; by_components.
Qed.

Lemma few_equations (K : list vec) : (length K <= 2)%nat ->
  exists d, d <> vzero /\ forall c, In c K -> dot c d = 0.
Proof.
  destruct K as [|a [|b [|c K]]]; simpl; intro H; [| | |lia].
  - exists (Vec 1 0 0). split; [unfold vzero; intro E; injection E; lra | tauto].
  - destruct (one_equation a) as (d & Hd & E). exists d. split; [assumption|].
    intros c [<- | []]. assumption.
  - destruct (two_equations a b) as (d & Hd & E & F). exists d. split; [assumption|].
    intros c [<- | [<- | []]]; assumption.
Qed.

Lemma squares_nonpositive L a :
  (forall p, In p L -> is_negative p = false -> dot (fst p) a = 0) ->
  squares L a <= 0 /\ (squares L a = 0 -> forall p, In p L -> dot (fst p) a = 0).
Proof.
  induction L as [|[c g] L IH]; simpl; intro H; [split; [lra | tauto]|].
  destruct IH as [N Z]; [intros; apply H; auto|].
  pose proof (H (c, g) (or_introl eq_refl)) as E. unfold is_negative in E. simpl in E.
  destruct (Rlt_dec g 0) as [G | G].
  - assert (g * (dot c a * dot c a) <= 0) by nra. split; [lra|].
    intros S p [<- | I]; simpl.
    + assert (P : g * (dot c a * dot c a) = 0) by lra.
      apply Rmult_integral in P. destruct P as [P | P]; [lra|].
      apply Rmult_integral in P. tauto.
    + apply Z; [lra | assumption].
  - rewrite (E eq_refl). split; [lra|]. intros S p [<- | I]; simpl; [auto|].
    apply Z; [lra | assumption].
Qed.

Lemma squares_nonnegative L a :
  (forall p, In p L -> is_negative p = true -> dot (fst p) a = 0) -> 0 <= squares L a.
Proof.
  induction L as [|[c g] L IH]; simpl; intro H; [lra|].
  assert (0 <= squares L a) by (apply IH; intros; apply H; auto).
  pose proof (H (c, g) (or_introl eq_refl)) as E. unfold is_negative in E. simpl in E.
  destruct (Rlt_dec g 0) as [G | G]; [rewrite (E eq_refl); lra|]. nra.
Qed.

Lemma filter_complement {X : Type} (f : X -> bool) L :
  (length (filter f L) + length (filter (fun x => negb (f x)) L) = length L)%nat.
Proof. induction L as [|x L IH]; simpl; [reflexivity|]. destruct (f x); simpl; lia. Qed.

Lemma index_not_less A n m : index A n -> index A m -> ~ (m < n)%nat.
Proof.
  intros (L & (L3 & LI & LA) & <-) (L' & (L3' & LI' & LA') & <-) H. unfold negatives in H.
  pose proof (filter_complement is_negative L) as P.
  destruct (few_equations (map fst (filter (fun p => negb (is_negative p)) L)
                           ++ map fst (filter is_negative L'))) as (a & Ha & E).
  { rewrite app_length, !map_length. lia. }
  apply Ha, LI.
  assert (S : squares L a = squares L' a) by (rewrite <- LA, <- LA'; reflexivity).
  destruct (squares_nonpositive L a) as [N Z].
  { intros p I Q. apply E, in_or_app. left. apply in_map, filter_In. rewrite Q. auto. }
  assert (0 <= squares L' a).
  { apply squares_nonnegative. intros p I Q. apply E, in_or_app. right.
    apply in_map, filter_In. auto. }
  apply Z. lra.
Qed.

(** Sylvester's law of inertia: the index does not depend on the squares chosen. *)
Theorem index_unique A n m : index A n -> index A m -> n = m.
Proof.
  intros Hn Hm. pose proof (index_not_less A n m Hn Hm). pose proof (index_not_less A m n Hm Hn).
  lia.
Qed.

(** The index is 0 just where no direction is negative. *)
Theorem index_zero_iff A n : index A n -> n = 0%nat <-> forall a, 0 <= quadratic A a.
Proof.
  intros (L & (L3 & LI & LA) & <-). split.
  - intros H a. rewrite LA. apply squares_nonnegative. intros p I Q. exfalso.
    unfold negatives in H. apply length_zero_iff_nil in H.
    assert (In p (filter is_negative L)) by (apply filter_In; auto). rewrite H in *. auto.
  - intro H. destruct (Nat.eq_dec (negatives L) 0) as [E0 | Pos]; [assumption | exfalso].
    pose proof (filter_complement is_negative L) as P. unfold negatives in Pos.
    destruct (few_equations (map fst (filter (fun p => negb (is_negative p)) L))) as (a & Ha & E).
    { rewrite map_length. lia. }
    apply Ha, LI. destruct (squares_nonpositive L a) as [N Z].
    { intros p I Q. apply E, in_map, filter_In. rewrite Q. auto. }
    apply Z. specialize (H a). rewrite LA in H. lra.
Qed.

(** ** The spectral theorem in space *)

Definition diag g1 g2 g3 := Mat g1 0 0 0 g2 0 0 0 g3.
Definition columns a b c :=
  Mat (v1 a) (v1 b) (v1 c) (v2 a) (v2 b) (v2 c) (v3 a) (v3 b) (v3 c).

(** A 4x4 matrix that acts on the vector part as S, and multiplies the scalar part by t. *)
Definition pad t S :=
  Sym t 0 0 0 (m11 S) (m12 S) (m13 S) (m22 S) (m23 S) (m33 S).
Definition vector_part q := Vec (qx q) (qy q) (qz q).

Lemma pad_apply t S q : symmetric S ->
  apply (pad t S) q =
  let a := mvec S (vector_part q) in Quat (t * qw q) (v1 a) (v2 a) (v3 a).
Proof.
  unfold symmetric. destruct S, q. unfold transpose, pad, apply, mvec, vector_part; simpl.
  intro H. injection H as H1 H2 H3 H4 H5 H6. subst. f_equal; ring.
Qed.

(** A symmetric 3x3 matrix is diagonal in an orthonormal basis. *)
Theorem spectral_theorem_in_space S : symmetric S ->
  exists W g1 g2 g3, mmul (transpose W) W = mid /\
                     mmul (transpose W) (mmul S W) = diag g1 g2 g3.
Proof.
  intro H. set (t := 2 * entries_bound (pad 0 S) + 1).
  destruct (spectral_theorem (pad t S)) as (k & u & Sp).
  pose proof (basis _ _ _ Sp) as O. pose proof (eigenvectors _ _ _ Sp) as E.
  assert (K1 : t <= k I1).
  { pose proof (largest_value _ k u e1 Sp) as L. revert L. unfold e1, pad. unfold_forms. lra. }
  assert (V : vector_part (u I1) = vzero).
  { pose proof (E I1) as E1. unfold eigen in E1. rewrite pad_apply in E1 by assumption.
    simpl in E1.
    assert (M : mvec S (vector_part (u I1)) = vscale (k I1) (vector_part (u I1))).
    { unfold qscale in E1. injection E1 as _ X Y Z. apply vec_eq; simpl; assumption. }
    assert (Q : quadratic S (vector_part (u I1)) <= (t - 1) * norm2 (vector_part (u I1))).
    { pose proof (form_bound (pad 0 S) (Quat 0 (qx (u I1)) (qy (u I1)) (qz (u I1)))) as B.
      apply Rabs_le_between in B. destruct B as [_ B].
      replace (form (pad 0 S) (Quat 0 (qx (u I1)) (qy (u I1)) (qz (u I1))))
        with (quadratic S (vector_part (u I1))) in B.
      - replace (qnorm2 (Quat 0 (qx (u I1)) (qy (u I1)) (qz (u I1))))
          with (norm2 (vector_part (u I1))) in B
          by (unfold qnorm2, qdot, norm2, dot, vector_part; simpl; ring).
        unfold t. lra.
      - unfold form. rewrite pad_apply by assumption.
        unfold quadratic, qdot, dot, vector_part; simpl. ring. }
    unfold quadratic in Q. rewrite M in Q.
    replace (dot (vector_part (u I1)) (vscale (k I1) (vector_part (u I1))))
      with (k I1 * norm2 (vector_part (u I1))) in Q
      by (generalize (k I1) (vector_part (u I1)); clear; by_components).
    apply norm2_zero. pose proof (norm2_nonnegative (vector_part (u I1))). nra. }
  assert (U1 : qw (u I1) * qw (u I1) = 1).
  { pose proof (O I1 I1) as O11. unfold qdot, vector_part, vzero in *. simpl in O11.
    injection V as V1 V2 V3. rewrite V1, V2, V3 in O11. lra. }
  assert (W0 : forall i, i <> I1 -> qw (u i) = 0).
  { intros i Hi. pose proof (O I1 i) as Oi. unfold qdot, vector_part, vzero in *.
    injection V as V1 V2 V3. rewrite V1, V2, V3 in Oi.
    assert (qw (u I1) * qw (u i) = 0)
      by (destruct (four_eq_dec I1 i); [congruence|]; lra).
    apply Rmult_integral in H0. destruct H0 as [Z | Z]; [|assumption].
    rewrite Z in U1. lra. }
  assert (D : forall i j, i <> I1 -> j <> I1 ->
    dot (vector_part (u i)) (vector_part (u j)) = if four_eq_dec i j then 1 else 0).
  { intros i j Hi Hj. rewrite <- O. unfold qdot, dot, vector_part. simpl.
    rewrite (W0 i Hi). ring. }
  assert (A : forall i, i <> I1 ->
    mvec S (vector_part (u i)) = vscale (k i) (vector_part (u i))).
  { intros i Hi. pose proof (E i) as Ei. unfold eigen in Ei. rewrite pad_apply in Ei by assumption.
    unfold qscale in Ei. simpl in Ei. injection Ei as _ X Y Z. apply vec_eq; simpl; assumption. }
  exists (columns (vector_part (u I2)) (vector_part (u I3)) (vector_part (u I4))), (k I2), (k I3),
    (k I4).
  assert (D' : forall i j, i <> I1 -> j <> I1 ->
    dot (vector_part (u i)) (mvec S (vector_part (u j))) =
    k j * (if four_eq_dec i j then 1 else 0)).
  { intros i j Hi Hj. rewrite (A j Hj), <- (D i j Hi Hj).
    generalize (k j) (vector_part (u i)) (vector_part (u j)). clear. by_components. }
  assert (N2 : I2 <> I1) by discriminate. assert (N3 : I3 <> I1) by discriminate.
  assert (N4 : I4 <> I1) by discriminate.
  pose proof (D I2 I2 N2 N2). pose proof (D I2 I3 N2 N3). pose proof (D I2 I4 N2 N4).
  pose proof (D I3 I3 N3 N3). pose proof (D I3 I4 N3 N4). pose proof (D I4 I4 N4 N4).
  pose proof (D' I2 I2 N2 N2). pose proof (D' I2 I3 N2 N3). pose proof (D' I2 I4 N2 N4).
  pose proof (D' I3 I2 N3 N2). pose proof (D' I3 I3 N3 N3). pose proof (D' I3 I4 N3 N4).
  pose proof (D' I4 I2 N4 N2). pose proof (D' I4 I3 N4 N3). pose proof (D' I4 I4 N4 N4).
  clear - H0 H1 H2 H3 H4 H5 H6 H7 H8 H9 H10 H11 H12 H13 H14.
  revert H0 H1 H2 H3 H4 H5 H6 H7 H8 H9 H10 H11 H12 H13 H14.
  generalize (vector_part (u I2)) (vector_part (u I3)) (vector_part (u I4)). simpl.
  intros [a1 a2 a3] [b1 b2 b3] [c1 c2 c3]. destruct S. unfold diag, columns. unfold_vectors. simpl.
  intros. split; f_equal; lra.
Qed.

(** ** Two forms at once *)

Lemma kernel_trivial A a : det A <> 0 -> mvec A a = vzero -> a = vzero.
Proof.
  intros H E. apply (scale_zero (det A)); [assumption|].
  transitivity (mvec (adjugate A) (mvec A a)); [clear; by_components|]. rewrite E. by_components.
Qed.

Lemma sqrt_unit J a : positive_definite J -> a <> vzero ->
  quadratic J (vscale (/ sqrt (quadratic J a)) a) = 1.
Proof.
  intros P H. specialize (P a H).
  replace (quadratic J (vscale (/ sqrt (quadratic J a)) a)) with
    (quadratic J a / (sqrt (quadratic J a) * sqrt (quadratic J a))).
  - rewrite sqrt_sqrt by lra. field. lra.
  - pose proof (sqrt_lt_R0 _ P). generalize dependent (sqrt (quadratic J a)). intros s Hs.
    destruct a, J. unfold_vectors. field. lra.
Qed.

Lemma orthonormal_frame J : symmetric J -> positive_definite J ->
  exists T, mmul (transpose T) (mmul J T) = mid.
Proof.
  intros Sy P.
  assert (step : forall b c, exists a, quadratic J a = 1 /\ dot b a = 0 /\ dot c a = 0).
  { intros b c. destruct (two_equations b c) as (d & Hd & B & C).
    exists (vscale (/ sqrt (quadratic J d)) d). split; [apply sqrt_unit; assumption|].
    assert (E : forall k x y, dot x (vscale k y) = k * dot x y) by by_components.
    rewrite !E, B, C. split; ring. }
  destruct (step vzero vzero) as (a & Ha & _).
  destruct (step (mvec J a) vzero) as (b & Hb & Hab & _).
  destruct (step (mvec J a) (mvec J b)) as (c & Hc & Hac & Hbc).
  exists (columns a b c). clear P step. revert Ha Hb Hab Hc Hac Hbc Sy. unfold symmetric.
  destruct J, a, b, c. unfold columns. unfold_vectors. intros.
  injection Sy as S1 S2 S3 S4 S5 S6. subst. f_equal; lra.
Qed.

(** B^T J B = I and B^T G B = diag g. *)
Theorem simultaneous_diagonalisation J G :
  symmetric J -> positive_definite J -> symmetric G ->
  exists B g1 g2 g3, mmul (transpose B) (mmul J B) = mid /\
                     mmul (transpose B) (mmul G B) = diag g1 g2 g3.
Proof.
  intros SJ P SG. destruct (orthonormal_frame J SJ P) as [T HT].
  assert (SS : symmetric (mmul (transpose T) (mmul G T))).
  { unfold symmetric in *. rewrite !transpose_mmul, SG.
    replace (transpose (transpose T)) with T by by_components. symmetry. apply mmul_assoc. }
  destruct (spectral_theorem_in_space _ SS) as (W & g1 & g2 & g3 & HW & HS).
  exists (mmul T W), g1, g2, g3. rewrite transpose_mmul.
  assert (E : forall X, mmul (mmul (transpose W) (transpose T)) (mmul X (mmul T W)) =
                        mmul (transpose W) (mmul (mmul (transpose T) (mmul X T)) W)).
  { intro X. rewrite !mmul_assoc. reflexivity. }
  rewrite !E, HT, mmul_id_left. auto.
Qed.

Lemma det_transpose A : det (transpose A) = det A.
Proof. by_components. Qed.

Lemma frame_invertible J B : mmul (transpose B) (mmul J B) = mid ->
  det B * det B * det J = 1 /\ det B <> 0 /\ det J <> 0.
Proof.
  intro H. apply (f_equal det) in H. rewrite !det_mmul, det_transpose in H.
  replace (det mid) with 1 in H by by_components.
  assert (E : det B * det B * det J = 1) by lra. split; [assumption|].
  split; intro Z; rewrite Z in E; lra.
Qed.

Lemma frame_diagonalises J G B g1 g2 g3 :
  mmul (transpose B) (mmul J B) = mid -> mmul (transpose B) (mmul G B) = diag g1 g2 g3 ->
  exists c1 c2 c3, diagonalised G ((c1, g1) :: (c2, g2) :: (c3, g3) :: nil).
Proof.
  intros HJ HG. destruct (frame_invertible J B HJ) as (_ & DB & DJ).
  set (A := mmul (transpose B) J).
  assert (DA : det A <> 0).
  { unfold A. rewrite det_mmul, det_transpose. intro Z. apply Rmult_integral in Z. tauto. }
  assert (whole : forall a, mvec B (mvec A a) = a).
  { intro a.
    assert (Z : vsub (mvec B (mvec A a)) a = vzero).
    { apply (kernel_trivial A); [assumption|].
      replace (mvec A (vsub (mvec B (mvec A a)) a)) with
        (vsub (mvec (mmul A B) (mvec A a)) (mvec A a)) by (clearbody A; clear; by_components).
      unfold A at 1. rewrite <- mmul_assoc, HJ, mvec_id. clearbody A. clear. by_components. }
    revert Z. generalize (mvec B (mvec A a)). intros [x y z] Z. destruct a.
    unfold vsub, vzero in Z. simpl in Z. injection Z as Z1 Z2 Z3. f_equal; lra. }
  pose (row := fun i => mvec (transpose A) i).
  exists (row (Vec 1 0 0)), (row (Vec 0 1 0)), (row (Vec 0 0 1)).
  assert (R1 : forall a, dot (row (Vec 1 0 0)) a = v1 (mvec A a))
    by (unfold row; clearbody A; clear; by_components).
  assert (R2 : forall a, dot (row (Vec 0 1 0)) a = v2 (mvec A a))
    by (unfold row; clearbody A; clear; by_components).
  assert (R3 : forall a, dot (row (Vec 0 0 1)) a = v3 (mvec A a))
    by (unfold row; clearbody A; clear; by_components).
  split; [reflexivity | split].
  - intros a H. apply (kernel_trivial A); [assumption|].
    apply vec_eq.
    + rewrite <- R1. apply (H (row (Vec 1 0 0), g1)). simpl; auto.
    + rewrite <- R2. apply (H (row (Vec 0 1 0), g2)). simpl; auto.
    + rewrite <- R3. apply (H (row (Vec 0 0 1), g3)). simpl; auto.
  - intro a. simpl. rewrite R1, R2, R3. rewrite <- (whole a) at 1.
    generalize (mvec A a). intro x.
    transitivity (quadratic (mmul (transpose B) (mmul G B)) x); [clear; by_components|].
    rewrite HG. unfold diag. clear. by_components.
Qed.

(** G b = g J b for the columns b of B. *)
Lemma frame_mode J G B g1 g2 g3 x :
  mmul (transpose B) (mmul J B) = mid -> mmul (transpose B) (mmul G B) = diag g1 g2 g3 ->
  forall g, mvec (diag g1 g2 g3) x = vscale g x ->
  mvec G (mvec B x) = vscale g (mvec J (mvec B x)).
Proof.
  intros HJ HG g H. destruct (frame_invertible J B HJ) as (_ & DB & _).
  assert (Z : vsub (mvec G (mvec B x)) (vscale g (mvec J (mvec B x))) = vzero).
  { apply (kernel_trivial (transpose B)); [rewrite det_transpose; assumption|].
    transitivity (vsub (mvec (mmul (transpose B) (mmul G B)) x)
                       (vscale g (mvec (mmul (transpose B) (mmul J B)) x)));
      [clear; by_components|].
    rewrite HG, HJ, H, mvec_id. clear. by_components. }
  revert Z. generalize (mvec G (mvec B x)) (mvec J (mvec B x)). intros [a b c] [d e f] Z.
  unfold vsub, vscale, vzero in *. simpl in *. injection Z as Z1 Z2 Z3. f_equal; lra.
Qed.
