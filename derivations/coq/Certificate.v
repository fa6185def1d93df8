(** What a certificate proves of its clouds.

    Claimed, for a unit quaternion q, v = q^T K q, level = v + delta - mu: where
    level I - K + mu q q^T is positive definite, the objective at R(q) exceeds the minimum by less
    than 2 delta, every optimum is at an angle with mu sin^2(angle / 2) < delta, the optimum is unique
    where delta <= mu, and the second eigenvalue of K is below the level. Where nu I - K is positive
    definite, the objective exceeds the minimum by less than 2 (nu - v). *)

Require Import Reals Lra List.
From Certreg Require Import Vectors Quaternions Davenport Spectral Clouds Moments Equilibria.
Open Scope R_scope.

Definition form_positive A := forall p, p <> qzero -> 0 < form A p.

(** level I - K + mu q q^T. *)
Definition bounding C q level mu :=
  sadd_square mu q (sshift level (sscale (-1) (davenport C))).
Definition certified C q level mu := form_positive (bounding C q level mu).

(** sin^2 of half the angle between two rotations, whose cosine is (tr(P^T R) - 1) / 2. *)
Definition sin2_half_angle P R := (3 - trace (mmul (transpose P) R)) / 4.

Lemma bounding_form C q level mu p :
  form (bounding C q level mu) p =
  level * qnorm2 p - form (davenport C) p + mu * (qdot q p * qdot q p).
Proof. unfold bounding. rewrite form_square, form_shift, form_sscale. ring. Qed.

Lemma certified_bound C q delta mu p : unit p ->
  certified C q (form (davenport C) q + delta - mu) mu ->
  form (davenport C) p - form (davenport C) q < delta - mu * (1 - qdot q p * qdot q p).
Proof.
  intros Hp H. specialize (H p (unit_nonzero p Hp)). rewrite bounding_form, Hp in H. lra.
Qed.

Lemma sin2_of_quaternions p q : unit p -> unit q ->
  sin2_half_angle (rot p) (rot q) = 1 - qdot p q * qdot p q.
Proof. intros Hp Hq. unfold sin2_half_angle. rewrite trace_between, Hp, Hq. field. Qed.

Lemma cauchy_schwarz p q : unit p -> unit q -> qdot q p * qdot q p <= 1.
Proof.
  intros Hp Hq. set (r := qadd p (qscale (- qdot q p) q)).
  pose proof (qnorm2_nonnegative r) as N. unfold r, qnorm2 in N.
  rewrite qdot_add, !qdot_add_right, !qdot_scale, !qdot_scale_right, (qdot_comm p q) in N.
  fold (qnorm2 p) (qnorm2 q) in N. rewrite Hp, Hq in N. lra.
Qed.

(** Gap: against every rotation and translation. *)
Theorem certified_gap l q delta mu P s : 0 < mass l -> unit q -> 0 <= mu ->
  certified (cross_covariance l) q (form (davenport (cross_covariance l)) q + delta - mu) mu ->
  rotation P ->
  objective l (rot q) (vsub (centre target l) (mvec (rot q) (centre source l)))
  - objective l P s < 2 * delta.
Proof.
  intros HM Hq Hmu H HP. destruct (every_rotation_has_a_quaternion P HP) as (p & Hp & <-).
  pose proof (certified_bound _ q delta mu p Hp H) as B.
  pose proof (cauchy_schwarz p q Hp Hq) as CS.
  rewrite !objective_reduction by (try lra; apply unit_quaternions_rotate; assumption).
  rewrite <- !davenport_form.
  replace (miss l (rot q) (vsub (centre target l) (mvec (rot q) (centre source l)))) with vzero
    by (unfold miss; generalize (centre target l) (mvec (rot q) (centre source l)); clear; by_components).
  replace (norm2 vzero) with 0 by by_components.
  pose proof (norm2_nonnegative (miss l (rot p) s)).
  assert (0 <= mass l * norm2 (miss l (rot p) s)) by (apply Rmult_le_pos; lra).
  assert (0 <= mu * (1 - qdot q p * qdot q p)) by (apply Rmult_le_pos; lra). lra.
Qed.

(** Angle: to every optimal rotation. *)
Theorem certified_angle C q delta mu P : unit q ->
  certified C q (form (davenport C) q + delta - mu) mu -> optimal_rotation C P ->
  mu * sin2_half_angle (rot q) P < delta.
Proof.
  intros Hq H [HP O]. destruct (every_rotation_has_a_quaternion P HP) as (p & Hp & <-).
  pose proof (certified_bound C q delta mu p Hp H) as B.
  specialize (O _ (unit_quaternions_rotate q Hq)). rewrite <- !davenport_form in O.
  rewrite (sin2_of_quaternions q p Hq Hp). lra.
Qed.

(** The second eigenvalue: any plane holds a vector across q. *)
Theorem certified_second_eigenvalue C k u q level mu : unit q ->
  spectral (davenport C) k u -> certified C q level mu -> k I2 < level.
Proof.
  intros Hq S H.
  assert (E : exists p, qnorm2 p > 0 /\ qdot q p = 0 /\ qdot p (u I3) = 0 /\ qdot p (u I4) = 0).
  { pose proof (basis _ _ _ S) as O.
    set (a := qdot q (u I1)). set (b := qdot q (u I2)).
    destruct (Req_dec a 0) as [A | A].
    - exists (u I1). rewrite !O. unfold qnorm2. rewrite O. simpl. repeat split; try lra. exact A.
    - exists (qadd (qscale b (u I1)) (qscale (- a) (u I2))).
      unfold qnorm2. rewrite !qdot_add, !qdot_add_right, !qdot_scale, !qdot_scale_right, !O.
      fold a b. simpl. repeat split; try lra. nra. }
  destruct E as (p & N & Z & Z3 & Z4).
  assert (Hp : p <> qzero) by (intro X; rewrite X in N; unfold qnorm2, qdot, qzero in N; simpl in N; lra).
  specialize (H p Hp). rewrite bounding_form, Z in H.
  assert (F : k I2 * qnorm2 p <= form (davenport C) p).
  { rewrite (form_expansion _ k u p S), (norm_expansion u p (basis _ _ _ S)). unfold sum4.
    rewrite Z3, Z4. destruct (order _ _ _ S) as (D1 & _).
    assert (0 <= (k I1 - k I2) * (qdot p (u I1) * qdot p (u I1))) by (apply Rmult_le_pos; nra).
    lra. }
  nra.
Qed.

(** Uniqueness of rotation and translation, where delta <= mu. *)
Theorem certified_unique l q delta mu : 0 < mass l -> unit q -> delta <= mu ->
  certified (cross_covariance l) q (form (davenport (cross_covariance l)) q + delta - mu) mu ->
  exactly_one (fun pose => optimal_pose l (fst pose) (snd pose)).
Proof.
  intros HM Hq D H. destruct (spectral_theorem (davenport (cross_covariance l))) as (k & u & S).
  apply (unique_registration_iff l k u HM S).
  pose proof (certified_second_eigenvalue _ k u q _ mu Hq S H).
  pose proof (largest_value _ k u q S) as L. rewrite Hq in L. lra.
Qed.

(** The dual bound. *)
Definition dual C nu := form_positive (sshift nu (sscale (-1) (davenport C))).

Lemma dual_bound C nu P : dual C nu -> rotation P -> trace (mmul (transpose P) C) < nu.
Proof.
  intros H HP. destruct (every_rotation_has_a_quaternion P HP) as (p & Hp & <-).
  specialize (H p (unit_nonzero p Hp)). rewrite form_shift, form_sscale, Hp in H.
  rewrite <- davenport_form. lra.
Qed.

(** Gap from a multiplier nu of the relaxation, against every rotation and translation. *)
Theorem dual_gap l q nu P s : 0 < mass l -> unit q -> dual (cross_covariance l) nu -> rotation P ->
  objective l (rot q) (vsub (centre target l) (mvec (rot q) (centre source l)))
  - objective l P s < 2 * (nu - form (davenport (cross_covariance l)) q).
Proof.
  intros HM Hq H HP. pose proof (dual_bound _ nu P H HP) as B.
  rewrite !objective_reduction by (try lra; try apply unit_quaternions_rotate; assumption).
  rewrite davenport_form.
  replace (miss l (rot q) (vsub (centre target l) (mvec (rot q) (centre source l)))) with vzero
    by (unfold miss; generalize (centre target l) (mvec (rot q) (centre source l)); clear; by_components).
  replace (norm2 vzero) with 0 by by_components.
  pose proof (norm2_nonnegative (miss l P s)).
  assert (0 <= mass l * norm2 (miss l P s)) by (apply Rmult_le_pos; lra). lra.
Qed.
