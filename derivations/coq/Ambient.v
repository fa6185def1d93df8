(** The paper's 18 variables: attitude as nine numbers, of which three are redundant.

    Claimed: the Jacobian of the paper's field at an equilibrium; six structural zeros at each of
    them: six independent combinations of the rates vanish identically, and where G and J are
    invertible the kernel is six-dimensional (one solution for each symmetric matrix) and the zero
    eigenvalue has no longer chains, so that its multiplicity is exactly six. *)

Require Import Reals Lra List.
From Coquelicot Require Import Coquelicot.
From Certreg Require Import Vectors Clouds Moments Equilibria Hessian Index Dynamics.
Open Scope R_scope.

(** Vectors of R^18 are states. *)
Definition inverse A := mscale (/ det A) (adjugate A).

(** The paper's total torque, R^T R = I used, for any matrix in the place of R. *)
Definition paper_torque mu l s :=
  vsum (fun p => vsub
    (vscale (spring p) (cross (source p) (mvec (transpose (attitude s))
                                               (vsub (target p) (position s)))))
    (vscale (mu * weight p) (cross (source p) (cross (spin s) (source p))))) (centred l).

Definition field mu l s :=
  State (velocity s) (mmul (attitude s) (hat (spin s))) (vscale (/ mass l) (force mu l s))
        (mvec (inverse (inertia l))
              (vsub (paper_torque mu l s) (cross (spin s) (mvec (inertia l) (spin s))))).

Definition jacobian mu l R z :=
  State (velocity z) (mmul R (hat (spin z)))
        (vsub (vscale (-2) (position z)) (vscale mu (velocity z)))
        (mvec (inverse (inertia l))
              (vsub (spring_torque l (attitude z)) (vscale mu (mvec (inertia l) (spin z))))).

Definition moved s t z :=
  State (vadd (position s) (vscale t (position z))) (madd (attitude s) (mscale t (attitude z)))
        (vadd (velocity s) (vscale t (velocity z))) (vadd (spin s) (vscale t (spin z))).

Definition entries s : list R :=
  let c := position s in let R := attitude s in let v := velocity s in let w := spin s in
  v1 c :: v2 c :: v3 c :: m11 R :: m12 R :: m13 R :: m21 R :: m22 R :: m23 R :: m31 R :: m32 R
  :: m33 R :: v1 v :: v2 v :: v3 v :: v1 w :: v2 w :: v3 w :: nil.

Lemma inverse_left A a : det A <> 0 -> mvec (inverse A) (mvec A a) = a.
Proof.
  intro H. unfold inverse. transitivity (mvec (mscale (/ det A) (mmul (adjugate A) A)) a).
  - generalize (/ det A). clear. by_components.
  - rewrite adjugate_mmul. generalize dependent (det A). clear. intros.
    open_vectors. unfold_vectors. f_equal; field; assumption.
Qed.

Lemma inverse_right A a : det A <> 0 -> mvec A (mvec (inverse A) a) = a.
Proof.
  intro H. unfold inverse. transitivity (mvec (mscale (/ det A) (mmul A (adjugate A))) a).
  - generalize (/ det A). clear. by_components.
  - rewrite mmul_adjugate. generalize dependent (det A). clear. intros.
    open_vectors. unfold_vectors. f_equal; field; assumption.
Qed.

Lemma paper_torque_of_moments mu s l :
  vsum (fun p => vsub
    (vscale (spring p) (cross (source p) (mvec (transpose (attitude s))
                                               (vsub (target p) (position s)))))
    (vscale (mu * weight p) (cross (source p) (cross (spin s) (source p))))) l =
  let D := mmul (transpose (attitude s)) (moment_yx l) in
  vsub (vsub (vscale 2 (vee (msub D (transpose D))))
             (vscale 2 (cross (moment_x l) (mvec (transpose (attitude s)) (position s)))))
       (vscale mu (mvec (moment_J l) (spin s))).
Proof.
  destruct s as [c R v w]. unfold spring. cbn [position attitude velocity spin]. cbv zeta.
  by_induction l.
Qed.

Lemma paper_torque_reduction mu l s : mass l <> 0 ->
  paper_torque mu l s = vsub (spring_torque l (attitude s)) (vscale mu (mvec (inertia l) (spin s))).
Proof.
  intro H. unfold paper_torque. rewrite paper_torque_of_moments. cbv zeta.
  unfold moment_x. rewrite sources_centred by assumption.
  change (moment_yx (centred l)) with (cross_covariance l).
  change (moment_J (centred l)) with (inertia l). unfold spring_torque. rewrite transpose_mmul.
  generalize (cross_covariance l) (inertia l) (position s) (attitude s) (spin s). clear.
  by_components.
Qed.

(** On rotations the paper's torque is that of the points. *)
Theorem paper_torque_is_torque mu l s : mass l <> 0 -> rotation (attitude s) ->
  paper_torque mu l s = torque mu l s.
Proof. intros H R. rewrite paper_torque_reduction, torque_reduction by assumption. reflexivity. Qed.

Lemma spring_torque_linear l R X t :
  spring_torque l (madd R (mscale t X)) = vadd (spring_torque l R) (vscale t (spring_torque l X)).
Proof. unfold spring_torque. generalize (cross_covariance l). by_components. Qed.

Definition rest_at R := State vzero R vzero vzero.

(** Of second order in t. *)
Definition remainder l z :=
  State vzero (mmul (attitude z) (hat (spin z))) vzero
        (mvec (inverse (inertia l)) (vscale (-1) (cross (spin z) (mvec (inertia l) (spin z))))).

Lemma field_expansion mu l R z t : mass l <> 0 -> balanced (cross_covariance l) R ->
  field mu l (moved (rest_at R) t z) =
  moved (moved (rest_at mzero) t (jacobian mu l R z)) (t * t) (remainder l z).
Proof.
  intros H [_ B]. apply spring_torque_zero in B. unfold field.
  rewrite paper_torque_reduction, force_reduction by assumption.
  unfold moved, rest_at, jacobian, remainder. cbn [position attitude velocity spin].
  rewrite spring_torque_linear, B.
  f_equal; [clear; by_components | clear; by_components | |].
  - generalize dependent (mass l). clear. intros m Hm. destruct z as [[] X [] w].
    cbn [position attitude velocity spin]. unfold_vectors. f_equal; field; assumption.
  - generalize (inverse (inertia l)) (inertia l) (spring_torque l (attitude z)) (spin z). clear.
    by_components.
Qed.

(** The Jacobian: every entry of the field is differentiable along every direction of R^18 at the
    equilibrium, with this derivative. *)
Theorem jacobian_is_the_derivative mu l R z i : mass l <> 0 -> balanced (cross_covariance l) R ->
  is_derive (fun t => nth i (entries (field mu l (moved (rest_at R) t z))) 0) 0
            (nth i (entries (jacobian mu l R z)) 0).
Proof.
  intros H B.
  apply (derive_ext (fun t => t * nth i (entries (jacobian mu l R z)) 0
                              + t * t * nth i (entries (remainder l z)) 0)).
  - intro t. rewrite (field_expansion mu l R z t H B).
    generalize (jacobian mu l R z) (remainder l z). clear.
    intros [c1 R1 w1 x1] [c2 R2 w2 x2].
    unfold entries, moved, rest_at. cbn [position attitude velocity spin]. unfold_vectors.
    do 18 (destruct i as [|i]; [simpl; ring|]). simpl. destruct i; ring.
  - generalize (nth i (entries (jacobian mu l R z)) 0) (nth i (entries (remainder l z)) 0).
    intros a b. auto_derive; [exact I | ring].
Qed.

(** ** Six zeros *)

Definition symmetric_part R X := madd (mmul (transpose R) X) (transpose (mmul (transpose R) X)).

(** Six combinations of the rates, one for each entry of a symmetric matrix, vanish identically. *)
Theorem six_rates_vanish mu l R z : rotation R ->
  symmetric_part R (attitude (jacobian mu l R z)) = mzero.
Proof.
  intros [orthogonal _]. unfold jacobian, symmetric_part. cbn [attitude].
  rewrite mmul_assoc, orthogonal, mmul_id_left. generalize (spin z). clear. by_components.
Qed.

(** They are independent: every symmetric matrix is the symmetric part of some attitude. *)
Theorem symmetric_parts_are_all S R : rotation R -> symmetric S ->
  symmetric_part R (mmul R (mscale (/ 2) S)) = S.
Proof.
  intros [orthogonal _] H. unfold symmetric_part. rewrite mmul_assoc, orthogonal, mmul_id_left.
  unfold symmetric in H. destruct S. unfold transpose in H. simpl in H.
  injection H as H1 H2 H3 H4 H5 H6. subst. unfold_vectors. f_equal; field.
Qed.

(** R^T X in its symmetric half and its axial vector. *)
Definition axial R X := vscale (/ 2) (vee (msub (mmul (transpose R) X) (transpose (mmul (transpose R) X)))).

Lemma attitude_split R X : rotation R ->
  X = mmul R (madd (mscale (/ 2) (symmetric_part R X)) (hat (axial R X))).
Proof.
  intro rotates. transitivity (mmul R (mmul (transpose R) X)).
  - rewrite mmul_assoc, rotation_transpose, mmul_id_left by assumption. reflexivity.
  - unfold symmetric_part, axial. generalize (mmul (transpose R) X). clear. intros [].
    f_equal. unfold_vectors. f_equal; field.
Qed.

Lemma torque_of_split l R S a : balanced (cross_covariance l) R -> symmetric S ->
  let D := mmul (transpose R) (cross_covariance l) in
  spring_torque l (mmul R (madd (mscale (/ 2) S) (hat a))) =
  vsub (vee (msub (mmul S D) (mmul D S))) (mvec (hessian (cross_covariance l) R) a).
Proof.
  intros [_ B] H. cbv zeta. unfold spring_torque, hessian.
  replace (mmul (transpose (mmul R (madd (mscale (/ 2) S) (hat a)))) (cross_covariance l))
    with (mmul (transpose (madd (mscale (/ 2) S) (hat a))) (mmul (transpose R) (cross_covariance l)))
    by (rewrite transpose_mmul, mmul_assoc; reflexivity).
  replace (mmul (transpose (cross_covariance l)) (mmul R (madd (mscale (/ 2) S) (hat a))))
    with (mmul (transpose (mmul (transpose R) (cross_covariance l))) (madd (mscale (/ 2) S) (hat a)))
    by (rewrite transpose_mmul, <- mmul_assoc; f_equal; generalize R; clear; by_components).
  revert B H. unfold symmetric. generalize (mmul (transpose R) (cross_covariance l)). clear.
  intros [d1 d2 d3 d4 d5 d6 d7 d8 d9] B H. destruct S as [s1 s2 s3 s4 s5 s6 s7 s8 s9], a.
  unfold transpose in B, H. simpl in B, H. injection B as B1 B2 B3 B4 B5 B6.
  injection H as H1 H2 H3 H4 H5 H6. subst. unfold_vectors. f_equal; field.
Qed.

Lemma symmetric_part_symmetric R X : symmetric (symmetric_part R X).
Proof. unfold symmetric, symmetric_part. generalize (mmul (transpose R) X). by_components. Qed.

Lemma jacobian_zero_iff mu l R z : rotation R -> det (inertia l) <> 0 ->
  jacobian mu l R z = rest_at mzero <->
  position z = vzero /\ velocity z = vzero /\ spin z = vzero /\
  spring_torque l (attitude z) = vzero.
Proof.
  intros rotates HJ. unfold jacobian, rest_at. split.
  - intro E.
    pose proof (f_equal position E) as Hv. pose proof (f_equal attitude E) as W.
    pose proof (f_equal velocity E) as A. pose proof (f_equal spin E) as T.
    cbn [position attitude velocity spin] in Hv, W, A, T. clear E.
    apply spin_vanishes in W; [|assumption]. rewrite Hv in A. rewrite W in T.
    assert (Hp : position z = vzero).
    { apply (scale_zero (-2)); [lra|]. rewrite <- A. generalize (position z). clear. by_components. }
    repeat split; try assumption.
    apply (f_equal (mvec (inertia l))) in T. rewrite inverse_right in T by assumption.
    transitivity (vsub (spring_torque l (attitude z)) (vscale mu (mvec (inertia l) vzero))).
    + generalize (spring_torque l (attitude z)) (inertia l). clear. by_components.
    + rewrite T. generalize (inertia l). clear. by_components.
  - intros (P & V & W & T). rewrite P, V, W, T. f_equal; clear; by_components.
Qed.

(** The kernel is a copy of the symmetric matrices: six dimensions. *)
Theorem kernel_is_six_dimensional mu l R S : balanced (cross_covariance l) R ->
  det (inertia l) <> 0 -> det (hessian (cross_covariance l) R) <> 0 -> symmetric S ->
  exactly_one (fun z => jacobian mu l R z = rest_at mzero /\ symmetric_part R (attitude z) = S).
Proof.
  intros B HJ HG HS. pose proof (proj1 B) as rotates.
  set (D := mmul (transpose R) (cross_covariance l)).
  set (w := vee (msub (mmul S D) (mmul D S))).
  exists (State vzero (mmul R (madd (mscale (/ 2) S)
            (hat (mvec (inverse (hessian (cross_covariance l) R)) w)))) vzero vzero).
  split; [split|].
  - apply jacobian_zero_iff; [assumption | assumption |].
    cbn [position attitude velocity spin]. repeat split.
    rewrite (torque_of_split l R S _ B HS). cbv zeta. fold D w.
    rewrite inverse_right by assumption. generalize w. clear. by_components.
  - cbn [attitude]. unfold symmetric_part. destruct rotates as [orthogonal _].
    rewrite mmul_assoc, orthogonal, mmul_id_left.
    generalize (mvec (inverse (hessian (cross_covariance l) R)) w). intro a.
    unfold symmetric in HS. clear - HS. destruct S, a. unfold transpose in HS. simpl in HS.
    injection HS as H1 H2 H3 H4 H5 H6. subst. unfold_vectors. f_equal; field.
  - intros [p X v x] [E P]. apply jacobian_zero_iff in E; [|assumption | assumption].
    cbn [position attitude velocity spin] in *. destruct E as (-> & -> & -> & T).
    rewrite (attitude_split R X rotates), P in T |- *.
    rewrite (torque_of_split l R S _ B HS) in T. cbv zeta in T. fold D w in T.
    assert (G : mvec (hessian (cross_covariance l) R) (axial R X) = w).
    { revert T. generalize w (mvec (hessian (cross_covariance l) R) (axial R X)). clear.
      intros [] []. unfold_vectors. intro T. injection T as T1 T2 T3. f_equal; lra. }
    rewrite <- G, inverse_left by assumption. reflexivity.
Qed.

(** No longer chains: what the Jacobian sends into its kernel, it sends to zero. *)
Theorem zero_is_semisimple mu l R z : balanced (cross_covariance l) R ->
  det (inertia l) <> 0 -> det (hessian (cross_covariance l) R) <> 0 ->
  jacobian mu l R (jacobian mu l R z) = rest_at mzero -> jacobian mu l R z = rest_at mzero.
Proof.
  intros B HJ HG E. pose proof (proj1 B) as rotates.
  assert (Z : symmetric mzero) by reflexivity.
  destruct (kernel_is_six_dimensional mu l R mzero B HJ HG Z) as (k & _ & U).
  rewrite (U (jacobian mu l R z)); [symmetry; apply U|].
  - split; [apply jacobian_zero_iff; [assumption | assumption |] |].
    + cbn [position attitude velocity spin rest_at]. repeat split.
      unfold spring_torque. generalize (cross_covariance l). clear. by_components.
    + unfold symmetric_part, rest_at. cbn [attitude]. clear. by_components.
  - split; [exact E | apply six_rates_vanish, rotates].
Qed.
