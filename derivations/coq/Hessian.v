(** The second variation of the potential at an equilibrium, and its index.

    Claimed: along c + t d, R exp(t s [a]) the potential has the first derivative - f . d - s tau . a
    and the second 2 M |d|^2 + s^2 a^T G a, with G = 2 tr(R^T C) I - R^T C - C^T R; at a balanced
    rotation the index of G is the number of eigenvalues of K above its own (Morse's index, and
    Morse and Bott's where eigenvalues repeat). *)

Require Import Reals Lra List Lia.
From Coquelicot Require Import Coquelicot.
From Certreg Require Import Vectors Quaternions Davenport Extremum Spectral Index Clouds Moments
  Equilibria.
Open Scope R_scope.

Definition hessian C R :=
  let D := mmul (transpose R) C in
  msub (mscale (2 * trace D) mid) (madd D (transpose D)).

Lemma hessian_symmetric C R : symmetric (hessian C R).
Proof. unfold symmetric, hessian. by_components. Qed.

(** ** Second variation *)

(** Rodrigues' formula: exp(t [a]) for |a| = 1. *)
Definition turn a t :=
  madd mid (madd (mscale (sin t) (hat a)) (mscale (1 - cos t) (mmul (hat a) (hat a)))).

Lemma turn_is_rotation a t : norm2 a = 1 -> rotation (turn a t).
Proof.
  intro H. pose proof (sin2_cos2 t) as E. unfold Rsqr in E. unfold turn.
  revert E. generalize (sin t) (cos t). intros s c E. destruct a as [x y z]. unfold rotation. unfold_vectors.
  assert (Hz : z * z = 1 - x * x - y * y) by lra.
  assert (Hs : s * s = 1 - c * c) by lra.
  split; [f_equal|]; ring [Hz Hs].
Qed.

Lemma turn_zero a : turn a 0 = mid.
Proof. unfold turn. rewrite sin_0, cos_0. by_components. Qed.

(** A body moved from the pose of s. *)
Definition displaced s d a r t :=
  State (vadd (position s) (vscale t d)) (mmul (attitude s) (turn a (r * t)))
        (velocity s) (spin s).

Lemma rotation_mmul P R : rotation P -> rotation R -> rotation (mmul P R).
Proof.
  intros [P1 P2] [R1 R2]. split.
  - rewrite transpose_mmul, mmul_assoc, <- (mmul_assoc (transpose R)), P1, mmul_id_right. exact R1.
  - rewrite det_mmul, P2, R2. ring.
Qed.

Lemma potential_along l s d a r t : mass l <> 0 -> rotation (attitude s) -> norm2 a = 1 ->
  potential l (displaced s d a r t) =
  mass l * (norm2 (position s) + 2 * t * dot (position s) d + t * t * norm2 d)
  + offset l - 2 * trace (mmul (transpose (attitude s)) (cross_covariance l))
  - sin (r * t) * dot (spring_torque l (attitude s)) a
  + (1 - cos (r * t)) * quadratic (hessian (cross_covariance l) (attitude s)) a.
Proof.
  intros H rotates Ha.
  pose proof (rotation_mmul _ _ rotates (turn_is_rotation a (r * t) Ha)) as turns.
  rewrite potential_reduction by assumption. clear turns.
  unfold offset, spring_torque, hessian, displaced, turn. cbn [position attitude].
  generalize (sin (r * t)) (cos (r * t)) (sum (fun p => weight p * norm2 (target p)) (centred l))
    (cross_covariance l) (mass l) (scatter l) (position s) (attitude s). clear H rotates.
  intros sn cs V C m S c R. destruct a as [x y z].
  assert (Hz : z * z = 1 - x * x - y * y) by (unfold norm2, dot in Ha; simpl in Ha; lra).
  open_vectors. unfold_vectors. ring [Hz].
Qed.

(** The first derivative of the potential along c + t d, R exp(t r [a]) is - f . d - tau . r a at
    rest: with f = - 2 M c and tau the springs' torque. *)
Theorem first_variation l s d a r : mass l <> 0 -> rotation (attitude s) -> norm2 a = 1 ->
  is_derive (fun t => potential l (displaced s d a r t)) 0
    (2 * mass l * dot (position s) d - dot (spring_torque l (attitude s)) (vscale r a)).
Proof.
  intros H rotates Ha. eapply is_derive_ext.
  - intro t. symmetry. apply potential_along; assumption.
  - auto_derive; [exact I|]. rewrite !Rmult_0_r, cos_0, sin_0.
    replace (dot (spring_torque l (attitude s)) (vscale r a))
      with (r * dot (spring_torque l (attitude s)) a)
      by (generalize (spring_torque l (attitude s)); clear; by_components). ring.
Qed.

(** The second derivative is 2 M |d|^2 + (r a)^T G (r a). *)
Theorem second_variation l s d a r : mass l <> 0 -> rotation (attitude s) -> norm2 a = 1 ->
  is_derive_n (fun t => potential l (displaced s d a r t)) 2 0
    (2 * mass l * norm2 d
     + quadratic (hessian (cross_covariance l) (attitude s)) (vscale r a)).
Proof.
  intros H rotates Ha. eapply is_derive_n_ext.
  - intro t. symmetry. apply potential_along; assumption.
  - replace (quadratic (hessian (cross_covariance l) (attitude s)) (vscale r a))
      with (r * r * quadratic (hessian (cross_covariance l) (attitude s)) a)
      by (generalize (hessian (cross_covariance l) (attitude s)); clear; by_components).
    set (g := quadratic _ a). set (h := dot (spring_torque l (attitude s)) a).
    set (k := offset l - 2 * trace (mmul (transpose (attitude s)) (cross_covariance l))).
    set (n := norm2 d). set (p := norm2 (position s)). set (e := dot (position s) d).
    set (m := mass l). clearbody g h k n p e m.
    apply (is_derive_ext
      (fun t => m * (2 * e + 2 * t * n) - r * cos (r * t) * h + r * sin (r * t) * g)).
    + intro t. symmetry. apply is_derive_unique. auto_derive; [exact I | ring].
    + auto_derive; [exact I|]. rewrite !Rmult_0_r, cos_0, sin_0. ring.
Qed.

(** The springs' torque answers a small turn with - G a. *)
Theorem torque_linearised l R a : norm2 a = 1 -> balanced (cross_covariance l) R ->
  let tau t := spring_torque l (mmul R (turn a t)) in
  let g := mvec (hessian (cross_covariance l) R) a in
  is_derive (fun t => v1 (tau t)) 0 (- v1 g) /\ is_derive (fun t => v2 (tau t)) 0 (- v2 g) /\
  is_derive (fun t => v3 (tau t)) 0 (- v3 g).
Proof.
  intros Ha [_ B]. unfold symmetric in B. unfold spring_torque, turn, hessian.
  assert (E : forall T, msub (mmul (transpose (mmul R T)) (cross_covariance l))
                             (mmul (transpose (cross_covariance l)) (mmul R T)) =
    msub (mmul (transpose T) (mmul (transpose R) (cross_covariance l)))
         (mmul (transpose (mmul (transpose R) (cross_covariance l))) T)).
  { intro T. generalize (cross_covariance l). clear. by_components. }
  cbv zeta. revert B E. generalize (mmul (transpose R) (cross_covariance l)). intros D B E.
  destruct D, a. unfold transpose in B. simpl in B. injection B as B1 B2 B3 B4 B5 B6. subst.
  split; [|split];
    (eapply is_derive_ext; [intro t; cbv beta; rewrite E; reflexivity |]; clear E; unfold_vectors;
     auto_derive; [exact I |]; rewrite cos_0, sin_0; ring).
Qed.

(** ** The index *)

(** G is a quadratic form in the quaternion: turn to tangent vectors of the 3-sphere. *)
Lemma hessian_form C q a :
  quadratic (hessian C (rot q)) a =
  form (davenport C) q * norm2 a - form (davenport C) (tangent q a).
Proof. unfold hessian. by_forms. Qed.

Lemma eigen_coordinates C k u j a : spectral (davenport C) k u ->
  quadratic (hessian C (rot (u j))) a =
  sum4 (fun i => (k j - k i) * (dot (cotangent (u j) (u i)) a * dot (cotangent (u j) (u i)) a)).
Proof.
  intro S. rewrite hessian_form.
  rewrite (eigen_form _ (k j) (u j) (basis_unit _ k u j S) (eigenvectors _ _ _ S j)).
  rewrite (form_expansion _ k u _ S).
  assert (N : norm2 a = sum4 (fun i => qdot (tangent (u j) a) (u i) * qdot (tangent (u j) a) (u i))).
  { rewrite <- (norm_expansion u _ (basis _ _ _ S)), tangent_norm, (basis_unit _ k u j S). ring. }
  rewrite N. unfold sum4. rewrite !(qdot_comm (tangent (u j) a)), !qdot_tangent. ring.
Qed.

Lemma coordinates_independent C k u j a : spectral (davenport C) k u ->
  (forall i, i <> j -> dot (cotangent (u j) (u i)) a = 0) -> a = vzero.
Proof.
  intros S H. apply norm2_zero.
  assert (Z : tangent (u j) a = qzero).
  { apply (orthogonal_to_all_is_zero u _ (basis _ _ _ S)). intro i.
    rewrite qdot_comm. destruct (four_eq_dec i j) as [-> | Hi].
    - apply tangent_orthogonal.
    - rewrite qdot_tangent. apply H, Hi. }
  pose proof (tangent_norm (u j) a) as N. rewrite Z, (basis_unit _ k u j S) in N.
  unfold qnorm2, qdot, qzero in N. simpl in N. lra.
Qed.

Definition others (j : four) : list four :=
  match j with I1 => I2 :: I3 :: I4 :: nil | I2 => I1 :: I3 :: I4 :: nil
             | I3 => I1 :: I2 :: I4 :: nil | I4 => I1 :: I2 :: I3 :: nil end.

(** At the j-th axis of an eigenbasis the index of G is the number of eigenvalues above the j-th. *)
Theorem index_at_eigenvector C k u j : spectral (davenport C) k u ->
  index (hessian C (rot (u j))) (above k j).
Proof.
  intro S. exists (map (fun i => (cotangent (u j) (u i), k j - k i)) (others j)).
  split; [split; [destruct j; reflexivity | split]|].
  - intros a H. apply (coordinates_independent C k u j a S). intros i Hi.
    apply (H (cotangent (u j) (u i), k j - k i)).
    apply in_map_iff. exists i. split; [reflexivity|].
    destruct i, j; try congruence; simpl; tauto.
  - intro a. rewrite (eigen_coordinates C k u j a S). unfold sum4.
    destruct j; simpl; ring.
  - unfold negatives, above, is_negative.
    destruct j; simpl;
      repeat match goal with
             | |- context [Rlt_dec ?x ?y] => destruct (Rlt_dec x y); simpl
             end; try reflexivity; exfalso; lra.
Qed.

(** Any unit eigenvector may stand in the basis: reflect the basis along the difference. *)
Definition reflect d q := qadd q (qscale (- (2 * qdot d q / qnorm2 d)) d).

Lemma reflect_isometry d p q : d <> qzero -> qdot (reflect d p) (reflect d q) = qdot p q.
Proof.
  intro H. apply qnorm2_positive in H. unfold reflect.
  rewrite qdot_add, !qdot_add_right, !qdot_scale, !qdot_scale_right, (qdot_comm p d).
  fold (qnorm2 d). field. lra.
Qed.

Lemma eigen_difference A k p q : eigen A k p -> eigen A k q -> eigen A k (qadd p (qscale (-1) q)).
Proof.
  unfold eigen. intros Hp Hq. rewrite apply_add, apply_scale, Hp, Hq. by_entries.
Qed.

Lemma reflect_swaps p q : unit p -> unit q -> qadd p (qscale (-1) q) <> qzero ->
  reflect (qadd p (qscale (-1) q)) p = q.
Proof.
  intros Hp Hq H. apply qnorm2_positive in H. unfold reflect.
  replace (2 * qdot (qadd p (qscale (-1) q)) p / qnorm2 (qadd p (qscale (-1) q))) with 1.
  - clear. by_entries.
  - assert (E : qnorm2 (qadd p (qscale (-1) q)) = 2 * qdot (qadd p (qscale (-1) q)) p).
    { unfold qnorm2. rewrite !qdot_add, !qdot_add_right, !qdot_scale, !qdot_scale_right.
      rewrite (qdot_comm q p). fold (qnorm2 p) (qnorm2 q). rewrite Hp, Hq. ring. }
    rewrite <- E. field. lra.
Qed.

(** Every unit eigenvector belongs to some orthonormal eigenbasis. *)
Theorem eigenvector_in_a_basis A k u j q : spectral A k u -> unit q -> eigen A (k j) q ->
  exists u', spectral A k u' /\ u' j = q.
Proof.
  intros S Hq E. set (d := qadd (u j) (qscale (-1) q)).
  destruct (quat_eq_dec d qzero) as [Z | H].
  - exists u. split; [assumption|]. unfold d, qadd, qscale, qzero in Z.
    destruct (u j), q. simpl in Z. injection Z as Z1 Z2 Z3 Z4. f_equal; lra.
  - assert (Ed : eigen A (k j) d) by (apply eigen_difference; [apply (eigenvectors _ _ _ S) | exact E]).
    exists (fun i => reflect d (u i)). split; [split|].
    + intros i i'. rewrite reflect_isometry by assumption. apply (basis _ _ _ S).
    + intro i. unfold reflect.
      destruct (eigenvector_components A k u (k j) d i S Ed) as [K | K].
      * unfold eigen. rewrite apply_add, apply_scale, (eigenvectors _ _ _ S i), Ed, K.
        generalize (2 * qdot d (u i) / qnorm2 d). intro. clearbody d. clear. by_entries.
      * rewrite K. unfold Rdiv. rewrite Rmult_0_r, Rmult_0_l, Ropp_0.
        unfold eigen. rewrite apply_add, apply_scale, (eigenvectors _ _ _ S i), Ed.
        clearbody d. clear. by_entries.
    + apply (order _ _ _ S).
    + apply reflect_swaps; [apply (basis_unit A k u j S) | assumption | exact H].
Qed.

(** The index of any equilibrium is the number of eigenvalues above its own. *)
Theorem morse_index C k u R : spectral (davenport C) k u -> balanced C R ->
  exists j, trace (mmul (transpose R) C) = k j /\ index (hessian C R) (above k j).
Proof.
  intros S B. destruct (balanced_has_eigenvector C R k u S B) as (q & j & Hq & <- & E).
  destruct (eigenvector_in_a_basis _ k u j q S Hq E) as (u' & S' & <-).
  exists j. split; [|apply index_at_eigenvector; assumption].
  rewrite <- davenport_form. apply eigen_form; assumption.
Qed.

(** The four equilibria of distinct eigenvalues have the indices 0, 1, 2, 3. *)
Theorem morse_indices_of_four C k u : spectral (davenport C) k u -> distinct k ->
  index (hessian C (rot (u I1))) 0 /\ index (hessian C (rot (u I2))) 1 /\
  index (hessian C (rot (u I3))) 2 /\ index (hessian C (rot (u I4))) 3.
Proof.
  intros S D. destruct (order _ _ _ S) as (D1 & D2 & D3).
  assert (N12 : k I1 <> k I2) by (apply D; discriminate).
  assert (N23 : k I2 <> k I3) by (apply D; discriminate).
  assert (N34 : k I3 <> k I4) by (apply D; discriminate).
  assert (A : above k I1 = 0%nat /\ above k I2 = 1%nat /\ above k I3 = 2%nat /\ above k I4 = 3%nat).
  { unfold above; simpl.
    repeat match goal with |- context [Rlt_dec ?x ?y] => destruct (Rlt_dec x y); try lra end.
    simpl. auto. }
  destruct A as (A1 & A2 & A3 & A4).
  split; [rewrite <- A1 | split; [rewrite <- A2 | split; [rewrite <- A3 | rewrite <- A4]]];
    apply index_at_eigenvector; assumption.
Qed.

Lemma above_zero k j : descending k -> above k j = 0%nat <-> k j = k I1.
Proof.
  intros (D1 & D2 & D3). unfold above; simpl.
  repeat match goal with |- context [Rlt_dec ?x ?y] => destruct (Rlt_dec x y); simpl end;
    destruct j; split; intro; try discriminate; try reflexivity; lra.
Qed.

(** Among equilibria, the optimal ones are those of index 0: there is no spurious local minimum. *)
Theorem optimal_iff_index_zero C R : balanced C R ->
  optimal_rotation C R <-> index (hessian C R) 0.
Proof.
  intro B. destruct (spectral_theorem (davenport C)) as (k & u & S).
  destruct (balanced_has_eigenvector C R k u S B) as (q & j & Hq & <- & E).
  destruct (eigenvector_in_a_basis _ k u j q S Hq E) as (u' & S' & <-).
  pose proof (index_at_eigenvector C k u' j S') as I.
  rewrite (optimal_value C k u' _ S' Hq), (eigen_form _ _ _ Hq E).
  rewrite <- (above_zero k j (order _ _ _ S)). split; intro H.
  - rewrite <- H. exact I.
  - apply (index_unique _ _ _ I H).
Qed.
