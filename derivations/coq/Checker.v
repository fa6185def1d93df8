(** A checker of certificates in integers, and the proof that what it accepts is true.

    Claimed: [check d s = true] implies [proved d s], a statement about the real clouds of [d].
    Not claimed: that a file was read rightly into [d] and [s] (the exporter is trusted to copy
    integers; its output can be read), its digest, where the points come from; and of the dynamics
    only what [Basin] and [Stability] say. *)

Require Import Reals Lra ZArith List Bool Lia.
From Coquelicot Require Import Coquelicot.
From Certreg Require Import Vectors Quaternions Davenport Spectral Index Clouds Moments Equilibria
  Hessian Stability Dynamics Certificate Basin Definite Integers.
Import ListNotations.
Open Scope R_scope.

(** What a certificate states; all numbers are those of the file. *)
Record statement := Statement {
  pose : zquat;
  delta : dyadic;
  mu : dyadic;
  gap : dyadic;
  sin2 : option dyadic;
  unique : bool;
  multiplicities : list Z;
  unstable : option (list Z);
  nu : option dyadic;
  sdp_gap : option dyadic;
  basin : bool;
  turned : option zquat;
  spinning : option (zvec * Z) }.  (* a velocity (a, b, c) 2^e *)

(** ** The checker *)

Inductive reason :=
  | a_weight_is_negative | no_weight_is_positive | pose_is_zero | delta_is_not_positive
  | mu_is_negative | pose_is_not_proved_optimal | gap_is_below_the_bound | angle_is_below_the_bound
  | pattern_is_wrong | optimum_is_not_unique | unstable_is_wrong_or_unproved | nu_bounds_nothing
  | sdp_gap_is_below_the_bound | basin_is_not_proved.

Definition is_zero q := (znorm2 q =? 0)%Z.
Definition unit_exponent d := (ew d + ex d + ey d)%Z.
Definition kernel d := zdavenport (zcovariance d).

(** M n (level I - K + mu q q^T / n) / 2^b, with n = |q|^2. *)
Definition zbounding d s :=
  let K := kernel d in let M := zmass d in let q := pose s in let n := znorm2 q in
  let e := unit_exponent d in
  let b := Z.min e (Z.min (exponent (delta s)) (exponent (mu s))) in
  let k := align b (Dyadic 1 e) in let U := (M * align b (mu s))%Z in let f := (n * k)%Z in
  let c := (k * zform K q + n * (M * align b (delta s) - U))%Z in
  ZSym (c - f * t00 K + U * (aw q * aw q)) (U * (aw q * ax q) - f * t01 K)
       (U * (aw q * ay q) - f * t02 K) (U * (aw q * az q) - f * t03 K)
       (c - f * t11 K + U * (ax q * ax q)) (U * (ax q * ay q) - f * t12 K)
       (U * (ax q * az q) - f * t13 K)
       (c - f * t22 K + U * (ay q * ay q)) (U * (ay q * az q) - f * t23 K)
       (c - f * t33 K + U * (az q * az q)).

(** M (nu I - K) / 2^b. *)
Definition zdual d x :=
  let K := kernel d in let e := unit_exponent d in let b := Z.min e (exponent x) in
  let k := align b (Dyadic 1 e) in let c := (zmass d * align b x)%Z in
  ZSym (c - k * t00 K) (- k * t01 K) (- k * t02 K) (- k * t03 K) (c - k * t11 K) (- k * t12 K)
       (- k * t13 K) (c - k * t22 K) (- k * t23 K) (c - k * t33 K).

(** g >= 2 (x - v), times M n / 2^b. *)
Definition covers d q g x :=
  let e := unit_exponent d in let M := zmass d in let n := znorm2 q in
  let b := Z.min e (Z.min (exponent g) (exponent x)) in
  (2 * (M * n * align b x - align b (Dyadic 1 e) * zform (kernel d) q) <=? M * n * align b g)%Z.

Definition zquadratic A a :=
  (z11 A * (b1 a * b1 a) + z22 A * (b2 a * b2 a) + z33 A * (b3 a * b3 a)
   + (z12 A + z21 A) * (b1 a * b2 a) + (z13 A + z31 A) * (b1 a * b3 a)
   + (z23 A + z32 A) * (b2 a * b3 a))%Z.

(** p^T K p / |p|^2 - w^T J w / 4 > level, times 4 M |p|^2 n / 2^b. *)
Definition inside d s p w :=
  let K := kernel d in let M := zmass d in let q := pose s in
  let n := znorm2 q in let m := znorm2 p in
  let e := unit_exponent d in let f := (ew d + ex d + ex d + 2 * snd w)%Z in
  let b := Z.min (Z.min e f) (Z.min (exponent (delta s)) (exponent (mu s))) in
  let k := align b (Dyadic 1 e) in
  (4 * m * (k * zform K q + M * n * (align b (delta s) - align b (mu s))) <?
   4 * n * (k * zform K p) - m * n * (align b (Dyadic 1 f) * zquadratic (zinertia d) (fst w)))%Z.

Definition in_basin d s :=
  match turned s, spinning s with
  | Some p, Some w => negb (is_zero p) && solid d && inside d s p w
  | _, _ => false
  end.

(** Sums of the multiplicities before each. *)
Fixpoint before (n : nat) (L : list nat) : list nat :=
  match L with [] => [] | m :: L => n :: before (n + m) L end.

Fixpoint same (a : list Z) (b : list nat) : bool :=
  match a, b with
  | [], [] => true
  | x :: a, y :: b => (x =? Z.of_nat y)%Z && same a b
  | _, _ => false
  end.

Definition given {X : Type} (x : option X) (test : X -> bool) :=
  match x with Some x => test x | None => true end.

Definition tests d s : list (reason * bool) :=
  let P := zpattern (zcovariance d) in
  [ (a_weight_is_negative, forallb (fun p => 0 <=? zw p)%Z (points d));
    (no_weight_is_positive, 0 <? zmass d)%Z;
    (pose_is_zero, negb (is_zero (pose s)));
    (delta_is_not_positive, 0 <? mantissa (delta s))%Z;
    (mu_is_negative, 0 <=? mantissa (mu s))%Z;
    (pose_is_not_proved_optimal, zpositive4 (zbounding d s));
    (gap_is_below_the_bound, at_most (twice (delta s)) (gap s));
    (angle_is_below_the_bound,
     given (sin2 s) (fun x => (0 <? mantissa (mu s))%Z && at_most (delta s) (times x (mu s))));
    (pattern_is_wrong, same (multiplicities s) P);
    (optimum_is_not_unique, negb (unique s) || (hd 0 P =? 1)%nat);
    (unstable_is_wrong_or_unproved,
     given (unstable s) (fun L => solid d && same L (before 0 P)));
    (nu_bounds_nothing, given (nu s) (fun x => zpositive4 (zdual d x)));
    (sdp_gap_is_below_the_bound,
     given (sdp_gap s) (fun g => match nu s with
                                 | Some x => covers d (pose s) g x
                                 | None => false
                                 end));
    (basin_is_not_proved, negb (basin s) || in_basin d s) ].

Definition check d s := forallb snd (tests d s).
(** Why a certificate is refused; [] means that it is accepted. *)
Definition reasons d s := map fst (filter (fun t => negb (snd t)) (tests d s)).

(** ** What it proves *)

Definition direction q := qscale (/ sqrt (qnorm2 (real_quat q))) (real_quat q).

(** The best translation for a rotation. *)
Definition best_translation l R := vsub (centre target l) (mvec R (centre source l)).

(** The linearised motion at R has exactly n roots with positive real part. *)
Definition unstable_count damping l R n :=
  exists roots, length roots = 12%nat /\ growing roots = n /\ det (inertia l) <> 0 /\
    forall z, linearised damping (inertia l) (hessian (cross_covariance l) R) z =
              (RtoC (det (inertia l)) * from_roots roots z)%C.

(** Along any motion from the state, whatever the damping: if the limits of the attitude are balanced
    (LaSalle), there is none but the optimum. *)
Definition ends_at_the_optimum l R w :=
  forall damping D s t0, 0 <= damping -> solution damping l D s -> D t0 ->
    attitude (s t0) = R -> spin (s t0) = w ->
    (forall P, limit_attitude D s P -> balanced (cross_covariance l) P) ->
    exists best, optimal_rotation (cross_covariance l) best /\
                 forall P, limit_attitude D s P -> P = best.

Record proved (d : data) (s : statement) : Prop := Proved {
  (** every rotation and translation has an objective above ours minus the claimed gap *)
  proved_gap : forall P t, rotation P ->
    objective (real_cloud d) (rot (direction (pose s)))
      (best_translation (real_cloud d) (rot (direction (pose s))))
    - objective (real_cloud d) P t < value (gap s);
  proved_angle : forall x, sin2 s = Some x -> forall P,
    optimal_rotation (cross_covariance (real_cloud d)) P ->
    sin2_half_angle (rot (direction (pose s))) P < value x;
  proved_unique : unique s = true ->
    exactly_one (fun pose => optimal_pose (real_cloud d) (fst pose) (snd pose));
  proved_pattern : forall k u,
    spectral (davenport (cross_covariance (real_cloud d))) k u ->
    map Z.of_nat (pattern k) = multiplicities s;
  proved_unstable : forall L, unstable s = Some L ->
    positive_definite (inertia (real_cloud d)) /\
    forall damping, 0 < damping ->
      (forall R, balanced (cross_covariance (real_cloud d)) R ->
         exists n, In (Z.of_nat n) L /\ unstable_count damping (real_cloud d) R n) /\
      (forall x, In x L -> exists R n, balanced (cross_covariance (real_cloud d)) R /\
         x = Z.of_nat n /\ unstable_count damping (real_cloud d) R n);
  proved_sdp_gap : forall g, sdp_gap s = Some g -> forall P t, rotation P ->
    objective (real_cloud d) (rot (direction (pose s)))
      (best_translation (real_cloud d) (rot (direction (pose s))))
    - objective (real_cloud d) P t < value g;
  proved_nu : forall x, nu s = Some x -> forall P, rotation P ->
    trace (mmul (transpose P) (cross_covariance (real_cloud d))) < value x;
  proved_basin : basin s = true -> exists p w, turned s = Some p /\ spinning s = Some w /\
    rotation (rot (direction p)) /\ positive_definite (inertia (real_cloud d)) /\
    ends_at_the_optimum (real_cloud d) (rot (direction p))
      (vscale (two (snd w)) (real_vec (fst w))) }.

(** ** The proof *)

Lemma nonzero_norm q : is_zero q = false -> 0 < IZR (znorm2 q) /\ real_quat q <> qzero.
Proof.
  unfold is_zero. rewrite Z.eqb_neq. intro H.
  assert (P : 0 <= IZR (znorm2 q)) by (rewrite znorm2_real; apply qnorm2_nonnegative).
  apply le_IZR in P. split; [apply IZR_lt; lia|]. intro E.
  assert (Z0 : IZR (znorm2 q) = 0)
    by (rewrite znorm2_real, E; unfold qnorm2, qdot, qzero; simpl; ring).
  apply (eq_IZR _ 0) in Z0. contradiction.
Qed.

Lemma direction_unit q : is_zero q = false -> unit (direction q).
Proof. intro H. apply normalised, (nonzero_norm q H). Qed.

Lemma direction_product q p : is_zero q = false ->
  qdot (direction q) p * qdot (direction q) p * IZR (znorm2 q) =
  qdot (real_quat q) p * qdot (real_quat q) p.
Proof.
  intro H. destruct (nonzero_norm q H) as [N _]. rewrite znorm2_real in *.
  unfold direction. rewrite !qdot_scale. pose proof (sqrt_lt_R0 _ N) as S.
  rewrite <- (sqrt_sqrt (qnorm2 (real_quat q))) at 3 by lra. field. lra.
Qed.

Lemma direction_form A q : is_zero q = false ->
  form A (direction q) * IZR (znorm2 q) = form A (real_quat q).
Proof.
  intro H. destruct (nonzero_norm q H) as [N _]. rewrite znorm2_real in *.
  unfold direction. rewrite form_scale. pose proof (sqrt_lt_R0 _ N) as S.
  rewrite <- (sqrt_sqrt (qnorm2 (real_quat q))) at 3 by lra. field. lra.
Qed.

Section Soundness.
Variable d : data.
Hypothesis mass_positive : 0 < IZR (zmass d).

Let l := real_cloud d.
Let C := cross_covariance l.
Let M := IZR (zmass d).

Lemma unit_positive : 0 < covariance_unit d.
Proof. apply Rdiv_lt_0_compat; [apply two_positive | exact mass_positive]. Qed.

Lemma cloud_mass : 0 < mass l.
Proof.
  unfold l. rewrite mass_real. apply Rmult_lt_0_compat; [exact mass_positive | apply two_positive].
Qed.

Lemma covariance_here : C = mscale (covariance_unit d) (real_mat (zcovariance d)).
Proof. apply covariance_real. pose proof mass_positive. lra. Qed.

(** M K = 2^e K_Z. *)
Lemma kernel_form p :
  M * form (davenport C) p = two (unit_exponent d) * form (real_sym (kernel d)) p.
Proof.
  rewrite covariance_here. unfold kernel. rewrite zdavenport_real.
  replace (davenport (mscale (covariance_unit d) (real_mat (zcovariance d))))
    with (sscale (covariance_unit d) (davenport (real_mat (zcovariance d))))
    by (generalize (covariance_unit d) (real_mat (zcovariance d)); intros c [];
        unfold_forms; f_equal; ring).
  rewrite form_sscale. unfold covariance_unit, unit_exponent, M.
  pose proof mass_positive. field. lra.
Qed.

Lemma bounding_real s p : is_zero (pose s) = false ->
  exists c, 0 < c /\ form (real_sym (zbounding d s)) p =
    c * form (bounding C (direction (pose s))
                (form (davenport C) (direction (pose s)) + value (delta s) - value (mu s))
                (value (mu s))) p.
Proof.
  intro H. destruct (nonzero_norm _ H) as [N _].
  pose proof (direction_product (pose s) p H) as DP.
  pose proof (direction_form (davenport C) (pose s) H) as DF.
  pose proof (kernel_form (real_quat (pose s))) as KQ. rewrite <- zform_real in KQ.
  pose proof (kernel_form p) as KP.
  set (b := Z.min (unit_exponent d) (Z.min (exponent (delta s)) (exponent (mu s)))).
  pose proof (align_value b (delta s)) as AD. pose proof (align_value b (mu s)) as AM.
  pose proof (align_value b (Dyadic 1 (unit_exponent d))) as AE.
  unfold value at 1 in AE. cbn [mantissa exponent] in AE. rewrite Rmult_1_l in AE.
  pose proof (two_positive b) as TB.
  specialize (AD ltac:(unfold b; lia)). specialize (AM ltac:(unfold b; lia)).
  specialize (AE ltac:(unfold b; lia)).
  exists (M * IZR (znorm2 (pose s)) / two b). split.
  { apply Rdiv_lt_0_compat; [apply Rmult_lt_0_compat; [exact mass_positive | assumption] | assumption]. }
  rewrite bounding_form.
  apply (Rmult_eq_reg_r (two b)); [|lra].
  set (n := IZR (znorm2 (pose s))) in *.
  transitivity ((two (unit_exponent d) * IZR (zform (kernel d) (pose s))
                 + M * n * (value (delta s) - value (mu s))) * qnorm2 p
                - n * (two (unit_exponent d) * form (real_sym (kernel d)) p)
                + M * value (mu s) * (qdot (real_quat (pose s)) p * qdot (real_quat (pose s)) p)).
  - rewrite <- AD, <- AM, <- AE. unfold zbounding. fold b. unfold n, M.
    generalize (align b (delta s)) (align b (mu s)) (align b (Dyadic 1 (unit_exponent d)))
      (two b) (zmass d) (zform (kernel d) (pose s)) (znorm2 (pose s)) (kernel d) (pose s).
    clear. intros D U k t m f n K q. destruct K as [k0 k1 k2 k3 k4 k5 k6 k7 k8 k9], q as [q0 q1 q2 q3], p.
    unfold real_sym, real_quat.
    cbn [t00 t01 t02 t03 t11 t12 t13 t22 t23 t33 aw ax ay az].
    repeat rewrite ?minus_IZR, ?plus_IZR, ?mult_IZR. unfold_forms. ring.
  - rewrite <- KQ, <- KP, <- DF, <- DP. fold n. field. lra.
Qed.

Lemma certified_real s : is_zero (pose s) = false -> zpositive4 (zbounding d s) = true ->
  certified C (direction (pose s))
    (form (davenport C) (direction (pose s)) + value (delta s) - value (mu s)) (value (mu s)).
Proof.
  intros H P. apply zpositive4_real in P. intros p Hp.
  destruct (bounding_real s p H) as (c & Hc & E). specialize (P p Hp). rewrite E in P. nra.
Qed.

Lemma dual_real x : zpositive4 (zdual d x) = true -> dual C (value x).
Proof.
  intros P. apply zpositive4_real in P. intros p Hp. specialize (P p Hp).
  pose proof (kernel_form p) as KP.
  set (b := Z.min (unit_exponent d) (exponent x)).
  pose proof (align_value b x) as AX. pose proof (align_value b (Dyadic 1 (unit_exponent d))) as AE.
  unfold value at 1 in AE. cbn [mantissa exponent] in AE. rewrite Rmult_1_l in AE.
  pose proof (two_positive b) as TB.
  specialize (AX ltac:(unfold b; lia)). specialize (AE ltac:(unfold b; lia)).
  rewrite form_shift, form_sscale.
  assert (E : form (real_sym (zdual d x)) p * two b =
              M * value x * qnorm2 p - two (unit_exponent d) * form (real_sym (kernel d)) p).
  { rewrite <- AX, <- AE. unfold zdual. fold b. unfold M.
    generalize (align b x) (align b (Dyadic 1 (unit_exponent d))) (two b) (zmass d) (kernel d).
    clear. intros X k t m K. destruct K as [k0 k1 k2 k3 k4 k5 k6 k7 k8 k9], p. unfold real_sym.
    cbn [t00 t01 t02 t03 t11 t12 t13 t22 t23 t33].
    repeat rewrite ?opp_IZR, ?minus_IZR, ?plus_IZR, ?mult_IZR. unfold_forms. ring. }
  rewrite <- KP in E.
  assert (0 < form (real_sym (zdual d x)) p * two b) by (apply Rmult_lt_0_compat; assumption).
  assert (0 < M) by exact mass_positive. nra.
Qed.

Lemma covers_real q g x : is_zero q = false -> covers d q g x = true ->
  2 * (value x - form (davenport C) (direction q)) <= value g.
Proof.
  intros H P. unfold covers in P. rewrite Z.leb_le in P. apply IZR_le in P.
  destruct (nonzero_norm _ H) as [N _].
  pose proof (direction_form (davenport C) q H) as DF.
  pose proof (kernel_form (real_quat q)) as KQ. unfold M in KQ.
  set (b := Z.min (unit_exponent d) (Z.min (exponent g) (exponent x))) in *.
  pose proof (align_value b x) as AX. pose proof (align_value b g) as AG.
  pose proof (align_value b (Dyadic 1 (unit_exponent d))) as AE.
  unfold value at 1 in AE. cbn [mantissa exponent] in AE. rewrite Rmult_1_l in AE.
  specialize (AX ltac:(unfold b; lia)). specialize (AE ltac:(unfold b; lia)).
  specialize (AG ltac:(unfold b; lia)).
  pose proof (two_positive b) as TB. pose proof mass_positive as MP.
  repeat rewrite ?minus_IZR, ?mult_IZR in P. rewrite zform_real in P.
  set (n := IZR (znorm2 q)) in *. set (m := IZR (zmass d)) in *.
  set (v := form (davenport C) (direction q)) in *.
  apply (Rmult_le_compat_r (two b)) in P; [|lra].
  assert (L : m * n * (2 * (value x - v)) <= m * n * value g).
  { rewrite <- AX, <- AG.
    assert (Q : m * n * v = IZR (align b (Dyadic 1 (unit_exponent d))) * two b
                            * form (real_sym (kernel d)) (real_quat q))
      by (rewrite AE, <- KQ, <- DF; ring). lra. }
  apply (Rmult_le_reg_l (m * n)); [apply Rmult_lt_0_compat; assumption | exact L].
Qed.

Lemma zquadratic_real A a : IZR (zquadratic A a) = quadratic (real_mat A) (real_vec a).
Proof.
  unfold zquadratic. repeat rewrite ?plus_IZR, ?mult_IZR.
  destruct A as [a0 a1 a2 a3 a4 a5 a6 a7 a8], a as [c0 c1 c2].
  unfold real_mat, real_vec. unfold_vectors. cbn [z11 z12 z13 z21 z22 z23 z31 z32 z33 b1 b2 b3]. ring.
Qed.

Lemma inside_real s p w : is_zero (pose s) = false -> is_zero p = false -> inside d s p w = true ->
  form (davenport C) (direction (pose s)) + value (delta s) - value (mu s) <
  form (davenport C) (direction p)
  - / 4 * quadratic (inertia l) (vscale (two (snd w)) (real_vec (fst w))).
Proof.
  intros H Hp P. unfold inside in P. rewrite Z.ltb_lt in P. apply IZR_lt in P.
  destruct (nonzero_norm _ H) as [N _]. destruct (nonzero_norm _ Hp) as [Np _].
  pose proof (direction_form (davenport C) (pose s) H) as DF.
  pose proof (direction_form (davenport C) p Hp) as DP.
  pose proof (kernel_form (real_quat (pose s))) as KQ. unfold M in KQ.
  pose proof (kernel_form (real_quat p)) as KP. unfold M in KP.
  set (f := (ew d + ex d + ex d + 2 * snd w)%Z) in *.
  set (b := Z.min (Z.min (unit_exponent d) f) (Z.min (exponent (delta s)) (exponent (mu s)))) in *.
  pose proof (align_value b (delta s)) as AD. pose proof (align_value b (mu s)) as AM.
  pose proof (align_value b (Dyadic 1 (unit_exponent d))) as AE.
  pose proof (align_value b (Dyadic 1 f)) as AF.
  unfold value at 1 in AE. unfold value at 1 in AF. cbn [mantissa exponent] in AE, AF. rewrite Rmult_1_l in AE, AF.
  specialize (AD ltac:(unfold b; lia)). specialize (AE ltac:(unfold b; lia)).
  specialize (AM ltac:(unfold b; lia)). specialize (AF ltac:(unfold b; lia)).
  pose proof (two_positive b) as TB. pose proof mass_positive as MP.
  repeat rewrite ?minus_IZR, ?plus_IZR, ?mult_IZR in P. rewrite !zform_real, zquadratic_real in P.
  set (n := IZR (znorm2 (pose s))) in *. set (np := IZR (znorm2 p)) in *.
  assert (J : IZR (zmass d) * quadratic (inertia l) (vscale (two (snd w)) (real_vec (fst w))) =
              two f * quadratic (real_mat (zinertia d)) (real_vec (fst w))).
  { unfold l. rewrite inertia_real by lra. rewrite quadratic_scale. unfold inertia_unit, f.
    rewrite !two_add. replace (2 * snd w)%Z with (snd w + snd w)%Z by lia. rewrite two_add.
    replace (quadratic (real_mat (zinertia d)) (vscale (two (snd w)) (real_vec (fst w))))
      with (two (snd w) * two (snd w) * quadratic (real_mat (zinertia d)) (real_vec (fst w)))
      by (generalize (real_mat (zinertia d)) (real_vec (fst w)); clear; by_components).
    field. lra. }
  set (m := IZR (zmass d)) in *.
  set (v := form (davenport C) (direction (pose s))) in *.
  set (vp := form (davenport C) (direction p)) in *.
  set (Q := quadratic (inertia l) (vscale (two (snd w)) (real_vec (fst w)))) in *.
  apply (Rmult_lt_compat_r (two b)) in P; [|assumption].
  assert (E1 : m * n * v = IZR (align b (Dyadic 1 (unit_exponent d))) * two b
                           * form (real_sym (kernel d)) (real_quat (pose s)))
    by (rewrite AE, <- KQ, <- DF; ring).
  assert (E2 : m * np * vp = IZR (align b (Dyadic 1 (unit_exponent d))) * two b
                           * form (real_sym (kernel d)) (real_quat p))
    by (rewrite AE, <- KP, <- DP; ring).
  assert (E3 : m * Q = IZR (align b (Dyadic 1 f)) * two b
                           * quadratic (real_mat (zinertia d)) (real_vec (fst w)))
    by (rewrite AF; exact J).
  assert (L : m * n * np * (4 * (v + value (delta s) - value (mu s))) <
              m * n * np * (4 * vp - Q)).
  { rewrite <- AD, <- AM.
    replace (m * n * np * (4 * (v + IZR (align b (delta s)) * two b - IZR (align b (mu s)) * two b)))
      with (4 * np * (m * n * v) + 4 * np * m * n * (IZR (align b (delta s)) * two b
            - IZR (align b (mu s)) * two b)) by ring.
    replace (m * n * np * (4 * vp - Q)) with (4 * n * (m * np * vp) - np * n * (m * Q)) by ring.
    rewrite E1, E2, E3. lra. }
  assert (T : 0 < m * n * np) by (repeat apply Rmult_lt_0_compat; assumption).
  apply Rmult_lt_reg_l in L; [|assumption]. lra.
Qed.

End Soundness.

Lemma same_lists a b : same a b = true -> a = map Z.of_nat b.
Proof.
  revert b. induction a as [|x a IH]; intros [|y b]; simpl; try discriminate; [reflexivity|].
  rewrite andb_true_iff, Z.eqb_eq. intros [-> H]. f_equal. auto.
Qed.

(** How many eigenvalues can lie above one: the sums of the multiplicities before. *)
Lemma pattern_counts k : descending k ->
  (forall j, In (above k j) (before 0 (pattern k))) /\
  forall n, In n (before 0 (pattern k)) -> exists j, above k j = n.
Proof.
  intros (D1 & D2 & D3). unfold pattern.
  destruct (Req_EM_T (k I1) (k I2)) as [E1 | E1], (Req_EM_T (k I2) (k I3)) as [E2 | E2],
    (Req_EM_T (k I3) (k I4)) as [E3 | E3];
    assert (A1 := eq_refl (above k I1)); assert (A2 := eq_refl (above k I2));
    assert (A3 := eq_refl (above k I3)); assert (A4 := eq_refl (above k I4));
    unfold above at 2 in A1; unfold above at 2 in A2; unfold above at 2 in A3;
    unfold above at 2 in A4; cbn [filter every] in A1, A2, A3, A4;
    repeat match goal with
           | H : context [Rlt_dec ?x ?y] |- _ => destruct (Rlt_dec x y); try (exfalso; lra)
           end;
    cbn [length] in A1, A2, A3, A4;
    (split;
     [ intros []; rewrite ?A1, ?A2, ?A3, ?A4; simpl; tauto
     | simpl; intros count Listed;
       solve [ decompose [or] Listed; try contradiction;
               solve [exists I1; lia | exists I2; lia | exists I3; lia | exists I4; lia] ] ]).
Qed.

Lemma balanced_axis C k u j : spectral (davenport C) k u -> balanced C (rot (u j)).
Proof.
  intro S. apply (eigenvector_balanced C (k j)); [apply (basis_unit _ k u j S)|].
  apply (eigenvectors _ _ _ S).
Qed.

Lemma unstable_counts l k u damping : spectral (davenport (cross_covariance l)) k u ->
  positive_definite (inertia l) -> 0 < damping ->
  (forall R, balanced (cross_covariance l) R ->
     exists n, In n (before 0 (pattern k)) /\ unstable_count damping l R n) /\
  (forall n, In n (before 0 (pattern k)) ->
     exists R, balanced (cross_covariance l) R /\ unstable_count damping l R n).
Proof.
  intros S P Hd. destruct (pattern_counts k (order _ _ _ S)) as [In1 In2]. split.
  - intros R B. destruct (unstable_roots_at_equilibrium damping l k u R Hd P S B)
      as (j & roots & _ & H). exists (above k j). split; [apply In1|]. exists roots. exact H.
  - intros n Hn. destruct (In2 n Hn) as [j <-]. exists (rot (u j)).
    split; [apply (balanced_axis _ k u j S)|].
    apply (unstable_roots_are_the_index damping _ _ _ Hd (inertia_symmetric l) P
             (hessian_symmetric _ _) (index_at_eigenvector _ k u j S)).
Qed.

Lemma first_is_one k : descending k -> hd 0%nat (pattern k) = 1%nat -> k I2 < k I1.
Proof.
  intros (D1 & _) H. unfold pattern in H.
  destruct (Req_EM_T (k I1) (k I2)) as [E1 | E1]; [|lra].
  destruct (Req_EM_T (k I2) (k I3)), (Req_EM_T (k I3) (k I4)); discriminate.
Qed.

Lemma forallb_cons {X : Type} (f : X -> bool) x rest :
  forallb f (x :: rest) = true <-> f x = true /\ forallb f rest = true.
Proof. apply andb_true_iff. Qed.

(** [cbn] instead would have the kernel evaluate the integers of [d]. *)
Lemma claimed a b : negb a || b = true -> a = true -> b = true.
Proof. intros H ->. exact H. Qed.

(** Whatever the checker accepts is true of the real clouds: gap, angle, uniqueness, pattern, numbers of
    unstable eigenvalues, dual bound and basin, as far as they are claimed. *)
Theorem checker_sound d s : check d s = true -> proved d s.
Proof.
  unfold check, tests. cbv zeta. rewrite !forallb_cons. unfold snd at 1 2 3 4 5 6 7 8 9 10 11 12 13 14.
  intros (W & HM & HQ & HD & HMu & HP & HG & HA & HPat & HU & HUn & HN & HS & HB & _).
  apply positive_real in HM. apply negb_true_iff in HQ.
  apply Z.leb_le in HMu. apply IZR_le in HMu.
  set (l := real_cloud d). set (C := cross_covariance l).
  pose proof (cloud_mass d HM) as mass_positive. fold l in mass_positive.
  pose proof (direction_unit (pose s) HQ) as U.
  pose proof (certified_real d HM s HQ HP) as cert. fold l C in cert.
  assert (mu_nonnegative : 0 <= value (mu s)).
  { unfold value. apply Rmult_le_pos; [exact HMu | left; apply two_positive]. }
  set (q := direction (pose s)) in *.
  set (v := form (davenport C) q) in *.
  assert (multiplicity : forall k u, spectral (davenport C) k u -> pattern k = zpattern (zcovariance d)).
  { intros k u S. apply (zpattern_real (zcovariance d) (covariance_unit d) k u).
    - apply unit_positive, HM.
    - rewrite <- covariance_real by lra. exact S. }
  destruct (spectral_theorem (davenport C)) as (k & u & S).
  constructor; fold l C.
  - intros P t R. apply at_most_value in HG. rewrite twice_value in HG.
    pose proof (certified_gap l q (value (delta s)) (value (mu s)) P t mass_positive U mu_nonnegative
                  cert R) as G. unfold best_translation. fold q. lra.
  - intros x E P O. rewrite E in HA. cbn [given] in HA. apply andb_true_iff in HA.
    destruct HA as [MP HA]. apply at_most_value in HA. rewrite times_value in HA.
    apply positive_real in MP.
    assert (0 < value (mu s)) by (apply Rmult_lt_0_compat; [exact MP | apply two_positive]).
    pose proof (certified_angle C q (value (delta s)) (value (mu s)) P U cert O) as A. fold q.
    apply (Rmult_lt_reg_l (value (mu s))); [assumption | lra].
  - intro E. apply (claimed _ _ HU), Nat.eqb_eq in E. clear HU. rename E into HU.
    rewrite <- (multiplicity k u S) in HU.
    apply (unique_registration_iff l k u mass_positive S), first_is_one; [apply (order _ _ _ S) | exact HU].
  - intros k' u' S'. rewrite (multiplicity k' u' S'). symmetry. apply same_lists, HPat.
  - intros L E. rewrite E in HUn. cbn [given] in HUn. apply andb_true_iff in HUn.
    destruct HUn as [HJ HL]. apply (solid_real d HM) in HJ. fold l in HJ. split; [exact HJ|].
    intros damping Hd. apply same_lists in HL. rewrite <- (multiplicity k u S) in HL.
    destruct (unstable_counts l k u damping S HJ Hd) as [One All]. split.
    + intros R B. destruct (One R B) as (n & Hn & H). exists n. split; [|exact H].
      rewrite HL. apply in_map, Hn.
    + intros x Hx. rewrite HL in Hx. apply in_map_iff in Hx. destruct Hx as (n & <- & Hn).
      destruct (All n Hn) as (R & B & H). exists R, n. auto.
  - intros g E P t R. rewrite E in HS. cbn [given] in HS.
    destruct (nu s) as [x|] eqn:Nu; [|discriminate]. cbn [given] in HN.
    pose proof (dual_gap l q (value x) P t mass_positive U (dual_real d HM x HN) R) as G.
    pose proof (covers_real d HM (pose s) g x HQ HS) as V. fold l C q v in V, G.
    unfold best_translation. fold q. lra.
  - intros x E P R. rewrite E in HN. cbn [given] in HN.
    apply (dual_bound C (value x) P (dual_real d HM x HN) R).
  - intro E. apply (claimed _ _ HB) in E. clear HB. rename E into HB. unfold in_basin in HB.
    destruct (turned s) as [p|]; [|discriminate]. destruct (spinning s) as [w|]; [|discriminate].
    rewrite !andb_true_iff in HB. destruct HB as [[Hp HJ] HI]. apply negb_true_iff in Hp.
    apply (solid_real d HM) in HJ. fold l in HJ.
    pose proof (inside_real d HM s p w HQ Hp HI) as I. fold l C q v in I.
    exists p, w. split; [reflexivity | split; [reflexivity|]].
    pose proof (unit_quaternions_rotate _ (direction_unit p Hp)) as Rp.
    split; [exact Rp | split; [exact HJ|]].
    intros damping D x t0 Hd Sol H0 Att Sp LaSalle.
    apply (motion_from_basin_ends_at_the_optimum damping l k u
             (v + value (delta s) - value (mu s)) D x t0); try assumption; try lra.
    + intro a. destruct (vec_eq_dec a vzero) as [-> | N]; [|left; apply HJ, N].
      right. generalize (inertia l). clear. by_components.
    + apply (certified_second_eigenvalue C k u q _ (value (mu s)) U S cert).
    + rewrite Att. exact Rp.
    + unfold in_certified_basin. rewrite Att, Sp, <- davenport_form. exact I.
Qed.
