(** Which poses are equilibria, how many there are, and which of them are optimal.

    Claimed: equilibria are the balanced poses, R^T C symmetric, at rest on the target's centre, and
    their quaternions the eigenvectors of Davenport's matrix; distinct eigenvalues give exactly four,
    pairwise half a turn apart; there are infinitely many just where an eigenvalue repeats; the
    optimum is unique just where the largest is simple; the eight rows of multiplicities.
    Not claimed: that distinct eigenvalues are generic. *)

Require Import Reals Lra List FinFun.
From Certreg Require Import Vectors Quaternions Davenport Spectral Clouds Moments.
Open Scope R_scope.

(** R^T C is symmetric: the springs' torque vanishes. *)
Definition balanced C R := rotation R /\ symmetric (mmul (transpose R) C).

(** No rotation has a larger tr(R^T C). *)
Definition optimal_rotation C R :=
  rotation R /\ forall P, rotation P ->
    trace (mmul (transpose P) C) <= trace (mmul (transpose R) C).
Definition spurious C R := balanced C R /\ ~ optimal_rotation C R.

(** No rotation and translation have a smaller objective. *)
Definition optimal_pose l R t :=
  rotation R /\ forall P s, rotation P -> objective l R t <= objective l P s.

Definition infinitely_many (P : mat -> Prop) := forall known : list mat, exists R, P R /\ ~ In R known.
Definition exactly_one {X : Type} (P : X -> Prop) := exists x, P x /\ forall y, P y -> y = x.

(** ** Balance *)

Lemma hat_zero w : hat w = mzero -> w = vzero.
Proof. intro H. rewrite <- (vee_hat w), H. reflexivity. Qed.

Lemma spin_vanishes R w : rotation R -> mmul R (hat w) = mzero -> w = vzero.
Proof.
  intros [orthogonal _] H. apply hat_zero.
  rewrite <- (mmul_id_left (hat w)), <- orthogonal, <- mmul_assoc, H. by_components.
Qed.

Lemma spring_torque_zero l R :
  spring_torque l R = vzero <-> symmetric (mmul (transpose R) (cross_covariance l)).
Proof.
  unfold spring_torque. rewrite <- symmetric_vee, transpose_mmul.
  replace (transpose (transpose R)) with R by by_components. split; intro H.
  - apply scale_zero in H; [assumption | lra].
  - rewrite H. by_components.
Qed.

(** All rates of the point-wise equations vanish just where the body is at rest, its centre on the
    target's, and R^T C is symmetric. *)
Theorem equilibrium_iff_balanced mu l s : mass l <> 0 -> rotation (attitude s) ->
  equilibrium mu l s <->
  position s = vzero /\ velocity s = vzero /\ spin s = vzero /\
  balanced (cross_covariance l) (attitude s).
Proof.
  intros H rotates. unfold equilibrium, balanced.
  rewrite force_reduction, torque_reduction by assumption.
  split.
  - intros (V & W & F & T). apply spin_vanishes in W; [|assumption].
    rewrite V in F. rewrite W in T.
    assert (F' : vscale (-2 * mass l) (position s) = vzero)
      by (rewrite <- F; clear; generalize (mass l) (position s); by_components).
    apply scale_zero in F'; [|lra].
    assert (T' : spring_torque l (attitude s) = vzero).
    { rewrite <- T. clear. generalize (spring_torque l (attitude s)) (inertia l). by_components. }
    apply spring_torque_zero in T'. auto.
  - intros (P & V & W & _ & B). rewrite P, V, W.
    apply spring_torque_zero in B. rewrite B.
    generalize (mass l) (inertia l) (attitude s). clear. intros m J R.
    repeat split; by_components.
Qed.

(** Equivalently, where the quaternion of the attitude is an eigenvector of Davenport's matrix. *)
Theorem equilibrium_iff_eigenvector mu l s : mass l <> 0 -> rotation (attitude s) ->
  equilibrium mu l s <->
  position s = vzero /\ velocity s = vzero /\ spin s = vzero /\
  exists q k, unit q /\ rot q = attitude s /\ eigen (davenport (cross_covariance l)) k q.
Proof.
  intros H rotates. rewrite equilibrium_iff_balanced by assumption.
  split; intros (P & V & W & B); (split; [|split; [|split]]); try assumption.
  - destruct (every_rotation_has_a_quaternion _ rotates) as (q & Hq & E).
    exists q, (form (davenport (cross_covariance l)) q). repeat split; try assumption.
    apply balanced_iff_eigenvector; [assumption|]. rewrite E. apply B.
  - destruct B as (q & k & Hq & E & A). split; [assumption|]. rewrite <- E. apply balanced_iff_eigenvector; [assumption|].
    rewrite (eigen_form _ k q Hq A). exact A.
Qed.

Lemma balanced_has_eigenvector C R k u : spectral (davenport C) k u -> balanced C R ->
  exists q i, unit q /\ rot q = R /\ eigen (davenport C) (k i) q.
Proof.
  intros S [rotates B]. destruct (every_rotation_has_a_quaternion R rotates) as (q & Hq & <-).
  apply balanced_iff_eigenvector in B; [|assumption].
  destruct (every_eigenvalue_is_listed _ k u _ q S B (unit_nonzero q Hq)) as [i E].
  rewrite E in B. exists q, i. auto.
Qed.

Lemma eigenvector_balanced C k q : unit q -> eigen (davenport C) k q -> balanced C (rot q).
Proof.
  intros Hq E. split; [apply unit_quaternions_rotate; assumption|].
  apply balanced_iff_eigenvector; [assumption|]. rewrite (eigen_form _ k q Hq E). exact E.
Qed.

(** ** Four equilibria *)

Definition distinct (k : four -> R) := forall i j, i <> j -> k i <> k j.

(** Distinct eigenvalues: four balanced rotations and no others, any two of them half a turn apart. *)
Theorem exactly_four_equilibria C k u : spectral (davenport C) k u -> distinct k ->
  (forall R, balanced C R <-> exists i, R = rot (u i)) /\
  (forall i j, i <> j -> half_turn_apart (rot (u i)) (rot (u j)) /\ rot (u i) <> rot (u j)).
Proof.
  intros S D. split.
  - intro R. split.
    + intro B. destruct (balanced_has_eigenvector C R k u S B) as (q & i & Hq & E & A).
      exists i. rewrite <- E.
      destruct (simple_eigenvector _ k u i q S) as [-> | ->]; auto. apply rot_opposite.
    + intros [i ->]. apply (eigenvector_balanced C (k i)).
      * apply (basis_unit _ k u i S).
      * apply (eigenvectors _ _ _ S).
  - intros i j H. pose proof (basis_unit _ k u i S) as Ui. pose proof (basis_unit _ k u j S) as Uj.
    assert (half_turn_apart (rot (u i)) (rot (u j))) as A.
    { apply orthogonal_quaternions_are_half_a_turn_apart; try assumption.
      rewrite (basis _ _ _ S). destruct (four_eq_dec i j); [contradiction | reflexivity]. }
    split; [assumption|]. apply half_turn_apart_differ; [|assumption].
    apply unit_quaternions_rotate, Ui.
Qed.

(** ** Infinitely many *)

Lemma injective_is_infinite (P : mat -> Prop) (f : nat -> mat) :
  (forall n, P (f n)) -> Injective f -> infinitely_many P.
Proof.
  intros HP Hf known.
  assert (E : Exists (fun n => ~ In (f n) known) (seq 0 (S (length known)))).
  { destruct (Exists_dec (fun n => ~ In (f n) known) (seq 0 (S (length known)))) as [E | E].
    - intro n. destruct (in_dec mat_eq_dec (f n) known); [right; tauto | left; assumption].
    - assumption.
    - exfalso.
      assert (I : incl (map f (seq 0 (S (length known)))) known).
      { intros R HR. apply in_map_iff in HR. destruct HR as (n & <- & Hn).
        destruct (in_dec mat_eq_dec (f n) known); [assumption|].
        exfalso. apply E, Exists_exists. exists n. auto. }
      apply NoDup_incl_length in I.
      + rewrite map_length, seq_length in I. exact (Nat.nle_succ_diag_l _ I).
      + apply Injective_map_NoDup; [assumption | apply seq_NoDup]. }
  apply Exists_exists in E. destruct E as (n & _ & Hn). exists (f n). auto.
Qed.

(** The rotations of u + n v, n = 0, 1, 2, ..., for orthonormal u and v. *)
Definition between u v (n : nat) :=
  qscale (/ sqrt (1 + INR n * INR n)) (qadd u (qscale (INR n) v)).

Lemma between_dot u v n m : unit u -> unit v -> qdot u v = 0 ->
  qdot (between u v n) (between u v m) * qdot (between u v n) (between u v m) =
  (1 + INR n * INR m) * (1 + INR n * INR m)
  / ((1 + INR n * INR n) * (1 + INR m * INR m)).
Proof.
  intros Hu Hv H. unfold between.
  rewrite qdot_scale, qdot_scale_right, qdot_add, !qdot_add_right, !qdot_scale, !qdot_scale_right.
  rewrite (qdot_comm v u), H. fold (qnorm2 u) (qnorm2 v). rewrite Hu, Hv.
  assert (Pn : 0 < 1 + INR n * INR n) by nra. assert (Pm : 0 < 1 + INR m * INR m) by nra.
  pose proof (sqrt_lt_R0 _ Pn). pose proof (sqrt_lt_R0 _ Pm).
  transitivity ((1 + INR n * INR m) * (1 + INR n * INR m) /
    ((sqrt (1 + INR n * INR n) * sqrt (1 + INR n * INR n))
     * (sqrt (1 + INR m * INR m) * sqrt (1 + INR m * INR m)))).
  - field. split; lra.
  - rewrite !sqrt_sqrt by lra. reflexivity.
Qed.

Lemma between_unit u v n : unit u -> unit v -> qdot u v = 0 -> unit (between u v n).
Proof.
  intros Hu Hv H. unfold unit, between, qnorm2.
  rewrite qdot_scale, qdot_scale_right, qdot_add, !qdot_add_right, !qdot_scale, !qdot_scale_right.
  rewrite (qdot_comm v u), H. fold (qnorm2 u) (qnorm2 v). rewrite Hu, Hv.
  assert (P : 0 < 1 + INR n * INR n) by nra. pose proof (sqrt_lt_R0 _ P).
  transitivity ((1 + INR n * INR n) / (sqrt (1 + INR n * INR n) * sqrt (1 + INR n * INR n)));
    [field; lra | rewrite sqrt_sqrt by lra; field; lra].
Qed.

Lemma between_injective u v : unit u -> unit v -> qdot u v = 0 ->
  Injective (fun n => rot (between u v n)).
Proof.
  intros Hu Hv H n m E.
  assert (D : forall n, qnorm2 (between u v n) = 1) by (intro; apply between_unit; assumption).
  pose proof (trace_between (between u v n) (between u v m)) as T. cbv beta in E.
  rewrite <- E, rot_orthogonal, !D, (between_dot u v m n Hu Hv H) in T.
  unfold trace, mscale, mid in T. simpl in T.
  assert (0 < 1 + INR n * INR n) by nra. assert (0 < 1 + INR m * INR m) by nra.
  assert (Q : (1 + INR m * INR n) * (1 + INR m * INR n)
              / ((1 + INR m * INR m) * (1 + INR n * INR n)) = 1) by lra.
  apply (Rmult_eq_compat_r ((1 + INR m * INR m) * (1 + INR n * INR n))) in Q.
  unfold Rdiv in Q. rewrite Rmult_assoc, Rinv_l, Rmult_1_r, Rmult_1_l in Q by nra.
  apply INR_eq. assert (Z : (INR n - INR m) * (INR n - INR m) = 0) by lra.
  apply Rmult_integral in Z. lra.
Qed.

Lemma eigen_between A k u v n : eigen A k u -> eigen A k v -> eigen A k (between u v n).
Proof.
  intros Hu Hv. unfold between. apply eigen_scale. unfold eigen in *.
  rewrite apply_add, apply_scale, Hu, Hv. generalize (INR n). by_entries.
Qed.

Lemma repeated_eigenvalue_circle C k u i j : spectral (davenport C) k u -> i <> j -> k i = k j ->
  infinitely_many (fun R => exists q, unit q /\ rot q = R /\ eigen (davenport C) (k i) q).
Proof.
  intros S H E.
  pose proof (basis_unit _ k u i S) as Ui. pose proof (basis_unit _ k u j S) as Uj.
  assert (O : qdot (u i) (u j) = 0)
    by (rewrite (basis _ _ _ S); destruct (four_eq_dec i j); [contradiction | reflexivity]).
  apply (injective_is_infinite _ (fun n => rot (between (u i) (u j) n)));
    [|apply between_injective; assumption].
  intro n. exists (between (u i) (u j) n). split; [|split; [reflexivity|]].
  - apply between_unit; assumption.
  - apply eigen_between; [|rewrite E]; apply (eigenvectors _ _ _ S).
Qed.

Lemma infinite_subset (P Q : mat -> Prop) : (forall R, P R -> Q R) ->
  infinitely_many P -> infinitely_many Q.
Proof. intros H I known. destruct (I known) as (R & HR & N). exists R. auto. Qed.

Lemma finite_not_infinite (P : mat -> Prop) known :
  (forall R, P R -> In R known) -> ~ infinitely_many P.
Proof. intros H I. destruct (I known) as (R & HR & N). auto. Qed.

Lemma repeated_or_distinct (k : four -> R) : (exists i j, i <> j /\ k i = k j) \/ distinct k.
Proof.
  destruct (Req_EM_T (k I1) (k I2)); [left; exists I1, I2; split; [discriminate | assumption]|].
  destruct (Req_EM_T (k I1) (k I3)); [left; exists I1, I3; split; [discriminate | assumption]|].
  destruct (Req_EM_T (k I1) (k I4)); [left; exists I1, I4; split; [discriminate | assumption]|].
  destruct (Req_EM_T (k I2) (k I3)); [left; exists I2, I3; split; [discriminate | assumption]|].
  destruct (Req_EM_T (k I2) (k I4)); [left; exists I2, I4; split; [discriminate | assumption]|].
  destruct (Req_EM_T (k I3) (k I4)); [left; exists I3, I4; split; [discriminate | assumption]|].
  right. intros [] [] H; congruence.
Qed.

(** Infinitely many balanced rotations just where an eigenvalue repeats. *)
Theorem infinite_iff_repeated_eigenvalue C k u : spectral (davenport C) k u ->
  infinitely_many (balanced C) <-> exists i j, i <> j /\ k i = k j.
Proof.
  intro S. split.
  - intro I. destruct (repeated_or_distinct k) as [H | D]; [assumption|]. exfalso.
    apply (finite_not_infinite (balanced C) (map (fun i => rot (u i)) every)); [|assumption].
    intros R B. apply (proj1 (exactly_four_equilibria C k u S D)) in B. destruct B as [i ->].
    apply in_map_iff. exists i. split; [reflexivity|]. destruct i; simpl; tauto.
  - intros (i & j & H & E). apply (infinite_subset _ _ (fun R X => X)).
    apply (infinite_subset (fun R => exists q, unit q /\ rot q = R /\ eigen (davenport C) (k i) q)).
    + intros R (q & Hq & <- & A). apply (eigenvector_balanced C (k i)); assumption.
    + apply (repeated_eigenvalue_circle C k u i j S H E).
Qed.

(** ** Optima *)

Lemma optimal_value C k u q : spectral (davenport C) k u -> unit q ->
  optimal_rotation C (rot q) <-> form (davenport C) q = k I1.
Proof.
  intros S Hq. split.
  - intros [_ H]. apply Rle_antisym.
    + pose proof (largest_value _ k u q S) as L. rewrite Hq in L. lra.
    + pose proof (basis_unit _ k u I1 S) as U1.
      specialize (H _ (unit_quaternions_rotate _ U1)). rewrite <- !davenport_form in H.
      rewrite (eigen_form _ (k I1) (u I1) U1 (eigenvectors _ _ _ S I1)) in H. exact H.
  - intro E. split; [apply unit_quaternions_rotate; assumption|]. intros P HP.
    destruct (every_rotation_has_a_quaternion P HP) as (p & Hp & <-).
    rewrite <- !davenport_form, E. pose proof (largest_value _ k u p S) as L. rewrite Hp in L. lra.
Qed.

(** The optimal rotations are those of the eigenvectors of the largest eigenvalue. *)
Theorem optimal_iff_top_eigenvector C k u q : spectral (davenport C) k u -> unit q ->
  optimal_rotation C (rot q) <-> eigen (davenport C) (k I1) q.
Proof.
  intros S Hq. rewrite (optimal_value C k u q S Hq). split.
  - intro E.
    assert (Z : forall i, k i = k I1 \/ qdot q (u i) = 0).
    { rewrite (form_expansion _ k u q S) in E.
      assert (N : sum4 (fun i => qdot q (u i) * qdot q (u i)) = 1)
        by (rewrite <- (norm_expansion u q (basis _ _ _ S)); exact Hq).
      destruct (order _ _ _ S) as (D1 & D2 & D3). unfold sum4 in *.
      assert (G : forall i, 0 <= (k I1 - k i) * (qdot q (u i) * qdot q (u i))).
      { intro i. apply Rmult_le_pos; [destruct i; lra | nra]. }
      pose proof (G I2) as G2. pose proof (G I3) as G3. pose proof (G I4) as G4.
      assert (T : (k I1 - k I2) * (qdot q (u I2) * qdot q (u I2))
                + (k I1 - k I3) * (qdot q (u I3) * qdot q (u I3))
                + (k I1 - k I4) * (qdot q (u I4) * qdot q (u I4)) = 0).
      { apply (f_equal (Rmult (k I1))) in N. lra. }
      assert (Y : forall i, (k I1 - k i) * (qdot q (u i) * qdot q (u i)) = 0)
        by (intros []; lra).
      intro i. specialize (Y i). apply Rmult_integral in Y. destruct Y as [Y | Y]; [left; lra|].
      right. apply Rmult_integral in Y. tauto. }
    unfold eigen.
    assert (W : qadd (apply (davenport C) q) (qscale (- k I1) q) = qzero).
    { apply (orthogonal_to_all_is_zero u _ (basis _ _ _ S)). intro i.
      rewrite qdot_add, qdot_scale, (apply_component _ k u q i S).
      destruct (Z i) as [-> | ->]; ring. }
    revert W. generalize (apply (davenport C) q) (k I1). intros [a b c d] m.
    destruct q. unfold qadd, qscale, qzero. simpl. intro W. injection W as W1 W2 W3 W4.
    f_equal; lra.
  - intro E. apply (eigen_form _ (k I1) q Hq E).
Qed.

(** There is an optimal rotation, and every one is balanced: the optimum is an equilibrium. *)
Theorem an_optimum_exists_and_is_balanced C :
  (exists R, optimal_rotation C R) /\ forall R, optimal_rotation C R -> balanced C R.
Proof.
  destruct (spectral_theorem (davenport C)) as (k & u & S). split.
  - exists (rot (u I1)). apply (optimal_iff_top_eigenvector C k u _ S (basis_unit _ k u I1 S)).
    apply (eigenvectors _ _ _ S).
  - intros R [rotates H]. destruct (every_rotation_has_a_quaternion R rotates) as (q & Hq & <-).
    apply (eigenvector_balanced C (k I1)); [assumption|].
    apply (optimal_iff_top_eigenvector C k u q S Hq). split; assumption.
Qed.

(** The optimal rotation is unique just where the largest eigenvalue is simple. *)
Theorem unique_optimum_iff_simple_top C k u : spectral (davenport C) k u ->
  exactly_one (optimal_rotation C) <-> k I2 < k I1.
Proof.
  intro S. destruct (order _ _ _ S) as (D1 & D2 & D3). split.
  - intros (R & HR & U). apply Rnot_le_lt. intro E. assert (E' : k I1 = k I2) by lra.
    destruct (repeated_eigenvalue_circle C k u I1 I2 S) with (known := R :: nil)
      as (P & (q & Hq & <- & A) & N); [discriminate | assumption |].
    apply N. left. symmetry. apply U. apply (optimal_iff_top_eigenvector C k u q S Hq). exact A.
  - intro H. exists (rot (u I1)). split.
    + apply (optimal_iff_top_eigenvector C k u _ S (basis_unit _ k u I1 S)).
      apply (eigenvectors _ _ _ S).
    + intros R [rotates O]. destruct (every_rotation_has_a_quaternion R rotates) as (q & Hq & <-).
      assert (A : eigen (davenport C) (k I1) q)
        by (apply (optimal_iff_top_eigenvector C k u q S Hq); split; assumption).
      destruct (simple_eigenvector _ k u I1 q S) as [-> | ->]; auto.
      * intros [] Hj; try lra. congruence.
      * apply rot_opposite.
Qed.

(** ** The table of multiplicities *)

(** Multiplicities of the eigenvalues, from the largest on. *)
Definition pattern (k : four -> R) : list nat :=
  match Req_EM_T (k I1) (k I2), Req_EM_T (k I2) (k I3), Req_EM_T (k I3) (k I4) with
  | right _, right _, right _ => 1 :: 1 :: 1 :: 1 :: nil
  | right _, left _, right _ => 1 :: 2 :: 1 :: nil
  | right _, right _, left _ => 1 :: 1 :: 2 :: nil
  | right _, left _, left _ => 1 :: 3 :: nil
  | left _, right _, right _ => 2 :: 1 :: 1 :: nil
  | left _, left _, right _ => 3 :: 1 :: nil
  | left _, right _, left _ => 2 :: 2 :: nil
  | left _, left _, left _ => 4 :: nil
  end%nat.

(** The eight rows: a unique optimum in four of them, infinitely many optima in the other four. *)
Theorem table_uniqueness C k u : spectral (davenport C) k u ->
  (exactly_one (optimal_rotation C) <->
   In (pattern k) ((1 :: 1 :: 1 :: 1 :: nil) :: (1 :: 2 :: 1 :: nil) :: (1 :: 1 :: 2 :: nil)
                   :: (1 :: 3 :: nil) :: nil)%nat) /\
  (infinitely_many (optimal_rotation C) <->
   In (pattern k) ((2 :: 1 :: 1 :: nil) :: (3 :: 1 :: nil) :: (2 :: 2 :: nil)
                   :: (4 :: nil) :: nil)%nat).
Proof.
  intro S. pose proof (unique_optimum_iff_simple_top C k u S) as U.
  destruct (order _ _ _ S) as (D1 & D2 & D3).
  assert (I : infinitely_many (optimal_rotation C) <-> k I1 = k I2).
  { split.
    - intro I. destruct (Req_EM_T (k I1) (k I2)); [assumption|]. exfalso.
      destruct (proj2 U) as (R & HR & H); [lra|].
      apply (finite_not_infinite (optimal_rotation C) (R :: nil)); [|assumption].
      intros P HP. left. symmetry. auto.
    - intro E. apply (infinite_subset
        (fun R => exists q, unit q /\ rot q = R /\ eigen (davenport C) (k I1) q)).
      + intros R (q & Hq & <- & A). apply (optimal_iff_top_eigenvector C k u q S Hq). exact A.
      + apply (repeated_eigenvalue_circle C k u I1 I2 S); [discriminate | assumption]. }
  rewrite U, I. unfold pattern.
  destruct (Req_EM_T (k I1) (k I2)) as [E1 | E1], (Req_EM_T (k I2) (k I3)) as [E2 | E2],
    (Req_EM_T (k I3) (k I4)) as [E3 | E3]; simpl;
    (split; split; intro H; try (decompose [or] H; congruence || lra); try tauto; try lra).
Qed.

(** How many spurious equilibria: infinitely many just where an eigenvalue below the largest repeats;
    otherwise one for each eigenvalue below the largest. *)
Theorem table_spurious C k u : spectral (davenport C) k u ->
  (infinitely_many (spurious C) <-> exists i j, i <> j /\ k i = k j /\ k i < k I1) /\
  ((forall i j, i <> j -> k i < k I1 -> k i <> k j) ->
   forall R, spurious C R <-> exists i, k i < k I1 /\ R = rot (u i)).
Proof.
  intro S. destruct (order _ _ _ S) as (D1 & D2 & D3).
  assert (top : forall i, k i <= k I1) by (intros []; lra).
  assert (not_top : forall q i, unit q -> eigen (davenport C) (k i) q -> k i < k I1 ->
                                spurious C (rot q)).
  { intros q i Hq A H. split; [apply (eigenvector_balanced C (k i)); assumption|].
    intro O. apply (optimal_value C k u q S Hq) in O. rewrite (eigen_form _ _ q Hq A) in O. lra. }
  assert (spurious_value : forall R, spurious C R ->
    exists q i, unit q /\ rot q = R /\ eigen (davenport C) (k i) q /\ k i < k I1).
  { intros R [B N]. destruct (balanced_has_eigenvector C R k u S B) as (q & i & Hq & <- & A).
    exists q, i. repeat split; try assumption. destruct (top i) as [H | H]; [assumption|].
    exfalso. apply N, (optimal_iff_top_eigenvector C k u q S Hq). rewrite <- H. exact A. }
  assert (simple : (forall i j, i <> j -> k i < k I1 -> k i <> k j) ->
                   forall R, spurious C R <-> exists i, k i < k I1 /\ R = rot (u i)).
  { intros D R. split.
    - intro H. destruct (spurious_value R H) as (q & i & Hq & <- & A & L). exists i.
      split; [assumption|].
      destruct (simple_eigenvector _ k u i q S) as [-> | ->]; auto; [|apply rot_opposite].
      intros j Hj E. apply (D i j); auto.
    - intros (i & L & ->). apply (not_top _ i); [apply (basis_unit _ k u i S) | | assumption].
      apply (eigenvectors _ _ _ S). }
  split; [|exact simple]. split.
  - intro I.
    assert (dec : forall i j, (i <> j /\ k i = k j /\ k i < k I1) \/
                              ~ (i <> j /\ k i = k j /\ k i < k I1)).
    { intros i j. destruct (four_eq_dec i j); [right; tauto|].
      destruct (Req_EM_T (k i) (k j)); [|right; tauto].
      destruct (Rlt_dec (k i) (k I1)); [left; auto | right; tauto]. }
    assert (dec1 : forall i, (exists j, i <> j /\ k i = k j /\ k i < k I1) \/
                             forall j, ~ (i <> j /\ k i = k j /\ k i < k I1)).
    { intro i. destruct (dec i I1); [left; eauto|]. destruct (dec i I2); [left; eauto|].
      destruct (dec i I3); [left; eauto|]. destruct (dec i I4); [left; eauto|].
      right. intros []; assumption. }
    destruct (dec1 I1); [eauto|]. destruct (dec1 I2); [eauto|].
    destruct (dec1 I3); [eauto|]. destruct (dec1 I4); [eauto|].
    exfalso. apply (finite_not_infinite (spurious C) (map (fun i => rot (u i)) every));
      [|assumption].
    intros R HR. apply simple in HR.
    + destruct HR as (i & _ & ->). apply in_map_iff. exists i. split; [reflexivity|].
      destruct i; simpl; tauto.
    + intros i j Hij L E. destruct i; [apply (H j) | apply (H0 j) | apply (H1 j) | apply (H2 j)];
        auto.
  - intros (i & j & Hij & E & L).
    apply (infinite_subset
      (fun R => exists q, unit q /\ rot q = R /\ eigen (davenport C) (k i) q)).
    + intros R (q & Hq & <- & A). apply (not_top q i); assumption.
    + apply (repeated_eigenvalue_circle C k u i j S); assumption.
Qed.

(** ** The objective *)

(** What is left of the objective when the translation is best. *)
Definition offset l :=
  sum (fun p => weight p * norm2 (target p)) (centred l) + trace (scatter l).

(** Where the centre of the moved cloud lies, seen from the target's. *)
Definition miss l R t := vsub (vadd t (mvec R (centre source l))) (centre target l).

(** The objective, as the translation's share, a constant, and - 2 tr(R^T C). *)
Theorem objective_reduction l R t : mass l <> 0 -> rotation R ->
  objective l R t =
  mass l * norm2 (miss l R t) + offset l - 2 * trace (mmul (transpose R) (cross_covariance l)).
Proof.
  intros H rotates.
  rewrite <- (every_translation l R t vzero vzero) at 1.
  set (s := State (vsub (vadd t (mvec R (centre source l))) (centre target l)) R vzero vzero).
  change R with (attitude s) at 1. rewrite <- potential_is_objective.
  rewrite potential_reduction by assumption. unfold offset, miss; simpl. ring.
Qed.

(** A pose minimises the objective just where its rotation is optimal and its translation takes
    the one weighted mean to the other. *)
Theorem optimal_pose_iff l R t : 0 < mass l ->
  optimal_pose l R t <->
  optimal_rotation (cross_covariance l) R /\
  t = vsub (centre target l) (mvec R (centre source l)).
Proof.
  intro H. assert (H' : mass l <> 0) by lra.
  assert (best : forall P, miss l P (vsub (centre target l) (mvec P (centre source l))) = vzero).
  { intro P. unfold miss. generalize (centre target l) (mvec P (centre source l)). by_components. }
  assert (Z : norm2 vzero = 0) by by_components.
  split.
  - intros [rotates O]. split; [split; [assumption|]|].
    + intros P HP. specialize (O P (vsub (centre target l) (mvec P (centre source l))) HP).
      rewrite !objective_reduction, best, Z in O by assumption.
      pose proof (norm2_nonnegative (miss l R t)). nra.
    + specialize (O R (vsub (centre target l) (mvec R (centre source l))) rotates).
      rewrite !objective_reduction, best, Z in O by assumption.
      pose proof (norm2_nonnegative (miss l R t)) as N.
      assert (M : miss l R t = vzero) by (apply norm2_zero; nra).
      unfold miss in M. revert M. generalize (centre target l) (mvec R (centre source l)).
      intros [a b c] [d e f]. destruct t. unfold_vectors. intro M. injection M as M1 M2 M3.
      f_equal; lra.
  - intros [[rotates O] ->]. split; [assumption|]. intros P s HP.
    rewrite !objective_reduction, best, Z by assumption.
    specialize (O P HP). pose proof (norm2_nonnegative (miss l P s)). nra.
Qed.

(** The paper's corollary, made true: rotation and translation are unique just where the largest
    eigenvalue is simple, whatever points are noncollinear. *)
Theorem unique_registration_iff l k u : 0 < mass l ->
  spectral (davenport (cross_covariance l)) k u ->
  exactly_one (fun pose => optimal_pose l (fst pose) (snd pose)) <-> k I2 < k I1.
Proof.
  intros H S. rewrite <- (unique_optimum_iff_simple_top _ k u S). split.
  - intros ([R t] & O & U). simpl in O. apply (optimal_pose_iff l R t H) in O.
    exists R. split; [apply O|]. intros P HP.
    assert (E : (P, vsub (centre target l) (mvec P (centre source l))) = (R, t))
      by (apply U; simpl; apply (optimal_pose_iff l P _ H); auto).
    congruence.
  - intros (R & O & U). exists (R, vsub (centre target l) (mvec R (centre source l))). split.
    + simpl. apply (optimal_pose_iff l R _ H). auto.
    + intros [P s] HP. simpl in HP. apply (optimal_pose_iff l P s H) in HP.
      destruct HP as [HP ->]. rewrite (U P HP). reflexivity.
Qed.
