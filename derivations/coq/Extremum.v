(** Every symmetric 4x4 matrix has a largest eigenvalue.

    Claimed: there is a unit u with A u = k u and p^T A p <= k |p|^2 for all p. The proof maximises
    q^T A q - |q|^4 / 2, first one variable after the other over a large box; a maximum over all of
    R^4 satisfies A q = |q|^2 q. *)

Require Import Reals Lra.
From Coquelicot Require Import Rcomplements.
From Certreg Require Import Vectors Quaternions Davenport.
Open Scope R_scope.

Definition within b x := - b <= x <= b.

(** ** Maxima of Lipschitz functions *)

Lemma lipschitz_continuous f L : (forall x y, Rabs (f x - f y) <= L * Rabs (x - y)) ->
  forall x, continuity_pt f x.
Proof.
  intros H x eps Heps. pose proof (Rabs_pos L).
  exists (eps / (Rabs L + 1)). split; [apply Rdiv_lt_0_compat; lra|].
  intros y [_ D]. simpl in *. unfold R_dist in *.
  apply Rle_lt_trans with (Rabs L * Rabs (y - x)).
  - eapply Rle_trans; [apply H|]. apply Rmult_le_compat_r; [apply Rabs_pos | apply RRle_abs].
  - apply Rle_lt_trans with ((Rabs L + 1) * Rabs (y - x)).
    + pose proof (Rabs_pos (y - x)). nra.
    + apply Rlt_le_trans with ((Rabs L + 1) * (eps / (Rabs L + 1))).
      * apply Rmult_lt_compat_l; lra.
      * right. field. lra.
Qed.

Lemma maximum_on_segment f L b : 0 <= b ->
  (forall x y, Rabs (f x - f y) <= L * Rabs (x - y)) ->
  exists m, within b m /\ forall x, within b x -> f x <= f m.
Proof.
  intros Hb H. destruct (continuity_ab_maj f (- b) b) as [m [H1 H2]]; [lra | |].
  - intros x _. exact (lipschitz_continuous f L H x).
  - exists m. split; [exact H2 | exact H1].
Qed.

(** The largest value over the last variable, as a function of the others; no choice is needed,
    since real numbers have suprema. *)
Lemma maximum_function {X : Type} (F : X -> R -> R) b :
  (forall x, exists m, within b m /\ forall z, within b z -> F x z <= F x m) ->
  exists M : X -> R, forall x,
    (forall z, within b z -> F x z <= M x) /\ exists z, within b z /\ M x = F x z.
Proof.
  intro H.
  pose (E := fun x v => exists z, within b z /\ v = F x z).
  assert (bounded : forall x, bound (E x)).
  { intro x. destruct (H x) as [m [Hm H']]. exists (F x m). intros v [z [Hz ->]]. auto. }
  assert (inhabited : forall x, exists v, E x v).
  { intro x. destruct (H x) as [m [Hm _]]. exists (F x m), m. auto. }
  exists (fun x => proj1_sig (completeness (E x) (bounded x) (inhabited x))).
  intro x. destruct (completeness (E x) (bounded x) (inhabited x)) as [v [upper least]]. simpl.
  destruct (H x) as [m [Hm H']]. split.
  - intros z Hz. apply upper. exists z. auto.
  - exists m. split; [assumption|]. apply Rle_antisym.
    + apply least. intros w [z [Hz ->]]. auto.
    + apply upper. exists m. auto.
Qed.

Lemma maximum_function_lipschitz {X : Type} (F : X -> R -> R) (M : X -> R) b d x y :
  (forall x, (forall z, within b z -> F x z <= M x) /\ exists z, within b z /\ M x = F x z) ->
  (forall z, Rabs (F x z - F y z) <= d) -> Rabs (M x - M y) <= d.
Proof.
  intros HM H. destruct (HM x) as [Ux [z1 [W1 E1]]], (HM y) as [Uy [z2 [W2 E2]]].
  pose proof (H z1) as H1. pose proof (H z2) as H2.
  pose proof (Ux z2 W2). pose proof (Uy z1 W1).
  apply Rabs_le_between in H1. apply Rabs_le_between in H2. apply Rabs_le_between. lra.
Qed.

Definition distance p q :=
  Rabs (qw p - qw q) + Rabs (qx p - qx q) + Rabs (qy p - qy q) + Rabs (qz p - qz q).
Definition in_box b q := within b (qw q) /\ within b (qx q) /\ within b (qy q) /\ within b (qz q).

Lemma maximum_on_box (F : quat -> R) L b : 0 <= b ->
  (forall p q, Rabs (F p - F q) <= L * distance p q) ->
  exists m, in_box b m /\ forall q, in_box b q -> F q <= F m.
Proof.
  intros Hb H.
  assert (zero : forall x, Rabs (x - x) = 0) by (intro; rewrite Rminus_diag_eq, Rabs_R0; auto).
  assert (E3 : exists M : R * R * R -> R, forall v,
    (forall z, within b z -> F (Quat (fst (fst v)) (snd (fst v)) (snd v) z) <= M v) /\
    exists z, within b z /\ M v = F (Quat (fst (fst v)) (snd (fst v)) (snd v) z)).
  { apply (maximum_function (fun v z => F (Quat (fst (fst v)) (snd (fst v)) (snd v) z))).
    intro v. apply (maximum_on_segment _ L b Hb). intros x y.
    eapply Rle_trans; [apply H|]. unfold distance; simpl. rewrite !zero. right; ring. }
  destruct E3 as [M3 H3].
  assert (L3 : forall v w, Rabs (M3 v - M3 w) <=
    L * (Rabs (fst (fst v) - fst (fst w)) + Rabs (snd (fst v) - snd (fst w))
         + Rabs (snd v - snd w))).
  { intros v w.
    apply (maximum_function_lipschitz
      (fun v z => F (Quat (fst (fst v)) (snd (fst v)) (snd v) z)) M3 b _ v w H3).
    intro z. eapply Rle_trans; [apply H|]. unfold distance; simpl. rewrite zero. right; ring. }
  assert (E2 : exists M : R * R -> R, forall v,
    (forall y, within b y -> M3 (v, y) <= M v) /\ exists y, within b y /\ M v = M3 (v, y)).
  { apply (maximum_function (fun v y => M3 (v, y))).
    intro v. apply (maximum_on_segment _ L b Hb). intros x y.
    eapply Rle_trans; [apply L3|]. simpl. rewrite !zero. right; ring. }
  destruct E2 as [M2 H2].
  assert (L2 : forall v w, Rabs (M2 v - M2 w) <=
    L * (Rabs (fst v - fst w) + Rabs (snd v - snd w))).
  { intros v w. apply (maximum_function_lipschitz (fun v y => M3 (v, y)) M2 b _ v w H2).
    intro y. eapply Rle_trans; [apply L3|]. simpl. rewrite zero. right; ring. }
  assert (E1 : exists M : R -> R, forall w,
    (forall x, within b x -> M2 (w, x) <= M w) /\ exists x, within b x /\ M w = M2 (w, x)).
  { apply (maximum_function (fun w x => M2 (w, x))).
    intro v. apply (maximum_on_segment _ L b Hb). intros x y.
    eapply Rle_trans; [apply L2|]. simpl. rewrite !zero. right; ring. }
  destruct E1 as [M1 H1].
  assert (L1 : forall v w, Rabs (M1 v - M1 w) <= L * Rabs (v - w)).
  { intros v w. apply (maximum_function_lipschitz (fun w x => M2 (w, x)) M1 b _ v w H1).
    intro x. eapply Rle_trans; [apply L2|]. simpl. rewrite zero. right; ring. }
  destruct (maximum_on_segment M1 L b Hb L1) as [w [Ww Uw]].
  destruct (H1 w) as [_ [x [Wx Ex]]]. destruct (H2 (w, x)) as [_ [y [Wy Ey]]].
  destruct (H3 (w, x, y)) as [_ [z [Wz Ez]]]. simpl in *.
  exists (Quat w x y z). split; [repeat split; apply Ww || apply Wx || apply Wy || apply Wz|].
  intros [w' x' y' z'] (Ww' & Wx' & Wy' & Wz'). simpl in *.
  rewrite <- Ez, <- Ey, <- Ex.
  apply Rle_trans with (M3 (w', x', y')); [apply (proj1 (H3 (w', x', y'))); assumption|].
  apply Rle_trans with (M2 (w', x')); [apply (proj1 (H2 (w', x'))); assumption|].
  apply Rle_trans with (M1 w'); [apply (proj1 (H1 w')); assumption|]. auto.
Qed.

(** ** Polynomials are Lipschitz on a box *)

Definition lipschitz_on b (F : quat -> R) :=
  exists L, 0 <= L /\ forall p q, in_box b p -> in_box b q ->
    Rabs (F p - F q) <= L * distance p q /\ Rabs (F p) <= L.

Lemma distance_nonnegative p q : 0 <= distance p q.
Proof. unfold distance. repeat apply Rplus_le_le_0_compat; apply Rabs_pos. Qed.

Lemma lipschitz_constant b k : lipschitz_on b (fun _ => k).
Proof.
  exists (Rabs k). split; [apply Rabs_pos|]. intros p q _ _.
  rewrite Rminus_diag_eq, Rabs_R0 by reflexivity.
  pose proof (distance_nonnegative p q). pose proof (Rabs_pos k). split; nra.
Qed.

Lemma lipschitz_coordinate b (g : quat -> R) : 0 <= b ->
  (forall p q, Rabs (g p - g q) <= distance p q) -> (forall q, in_box b q -> within b (g q)) ->
  lipschitz_on b g.
Proof.
  intros Hb H W. exists (b + 1). split; [lra|]. intros p q Hp Hq. split.
  - pose proof (distance_nonnegative p q). pose proof (H p q). nra.
  - apply Rabs_le_between. specialize (W p Hp). unfold within in W. lra.
Qed.

Lemma lipschitz_add b F G : lipschitz_on b F -> lipschitz_on b G ->
  lipschitz_on b (fun q => F q + G q).
Proof.
  intros [L [HL H]] [K [HK I]]. exists (L + K). split; [lra|]. intros p q Hp Hq.
  destruct (H p q Hp Hq) as [H1 H2], (I p q Hp Hq) as [I1 I2]. split.
  - replace (F p + G p - (F q + G q)) with ((F p - F q) + (G p - G q)) by ring.
    eapply Rle_trans; [apply Rabs_triang|]. lra.
  - eapply Rle_trans; [apply Rabs_triang|]. lra.
Qed.

Lemma lipschitz_mult b F G : lipschitz_on b F -> lipschitz_on b G ->
  lipschitz_on b (fun q => F q * G q).
Proof.
  intros [L [HL H]] [K [HK I]]. exists (2 * L * K). split; [nra|]. intros p q Hp Hq.
  destruct (H p q Hp Hq) as [H1 H2], (I p q Hp Hq) as [I1 I2].
  destruct (H q q Hq Hq) as [_ H3].
  pose proof (Rabs_pos (F p)). pose proof (Rabs_pos (G p)). pose proof (Rabs_pos (F q)).
  split.
  - replace (F p * G p - F q * G q) with ((F p - F q) * G p + F q * (G p - G q)) by ring.
    eapply Rle_trans; [apply Rabs_triang|]. rewrite !Rabs_mult.
    pose proof (distance_nonnegative p q). pose proof (Rabs_pos (F p - F q)).
    pose proof (Rabs_pos (G p - G q)).
    assert (Rabs (F p - F q) * Rabs (G p) <= (L * distance p q) * K)
      by (apply Rmult_le_compat; lra).
    assert (Rabs (F q) * Rabs (G p - G q) <= L * (K * distance p q))
      by (apply Rmult_le_compat; lra).
    lra.
  - rewrite Rabs_mult. assert (Rabs (F p) * Rabs (G p) <= L * K) by (apply Rmult_le_compat; lra).
    nra.
Qed.

Definition clamp b x := Rmax (- b) (Rmin b x).

Lemma clamp_within b x : 0 <= b -> within b (clamp b x).
Proof. unfold within, clamp, Rmax, Rmin. intro. repeat destruct Rle_dec; lra. Qed.

Lemma clamp_inside b x : within b x -> clamp b x = x.
Proof. unfold within, clamp, Rmax, Rmin. intro. repeat destruct Rle_dec; lra. Qed.

Lemma clamp_contracts b x y : 0 <= b -> Rabs (clamp b x - clamp b y) <= Rabs (x - y).
Proof.
  unfold clamp, Rmax, Rmin, Rabs. intro.
  repeat destruct Rle_dec; repeat destruct Rcase_abs; lra.
Qed.

Definition clamped b q := Quat (clamp b (qw q)) (clamp b (qx q)) (clamp b (qy q)) (clamp b (qz q)).

Lemma maximum_of_lipschitz b F : 0 <= b -> lipschitz_on b F ->
  exists m, in_box b m /\ forall q, in_box b q -> F q <= F m.
Proof.
  intros Hb [L [HL H]].
  assert (box : forall q, in_box b (clamped b q))
    by (intro; repeat split; apply clamp_within, Hb).
  destruct (maximum_on_box (fun q => F (clamped b q)) L b Hb) as [m [Bm Um]].
  - intros p q. eapply Rle_trans; [apply (proj1 (H _ _ (box p) (box q)))|].
    apply Rmult_le_compat_l; [assumption|]. unfold distance, clamped; simpl.
    repeat apply Rplus_le_compat; apply clamp_contracts, Hb.
  - assert (same : forall q, in_box b q -> clamped b q = q).
    { intros [w x y z] (A & B & D & E). unfold clamped; simpl in *.
      rewrite !clamp_inside by assumption. reflexivity. }
    exists m. split; [assumption|]. intros q Hq.
    specialize (Um q Hq). rewrite !same in Um by assumption. exact Um.
Qed.

(** ** The quartic *)

Definition quartic A q := form A q - / 2 * (qnorm2 q * qnorm2 q).

Lemma quartic_lipschitz A b : 0 <= b -> lipschitz_on b (quartic A).
Proof.
  intro Hb.
  assert (W : lipschitz_on b qw /\ lipschitz_on b qx /\ lipschitz_on b qy /\ lipschitz_on b qz).
  { repeat split; apply lipschitz_coordinate; auto; try (intros q Q; apply Q);
      intros p q; unfold distance;
      pose proof (Rabs_pos (qw p - qw q)); pose proof (Rabs_pos (qx p - qx q));
      pose proof (Rabs_pos (qy p - qy q)); pose proof (Rabs_pos (qz p - qz q)); lra. }
  destruct W as (Hw & Hx & Hy & Hz).
  unfold quartic, form, qnorm2, qdot, apply; simpl.
  unfold Rminus. apply lipschitz_add.
  - repeat (apply lipschitz_add || apply lipschitz_mult || assumption || apply lipschitz_constant).
  - assert (E : forall F, lipschitz_on b (fun q => (-1) * F q) -> lipschitz_on b (fun q => - F q)).
    { intros F [L [HL H]]. exists L. split; [assumption|]. intros p q Hp Hq.
      replace (- F p - - F q) with (-1 * F p - -1 * F q) by ring.
      replace (- F p) with (-1 * F p) by ring. auto. }
    apply E.
    repeat (apply lipschitz_add || apply lipschitz_mult || assumption || apply lipschitz_constant).
Qed.

Definition entries_bound A :=
  Rabs (s00 A) + Rabs (s01 A) + Rabs (s02 A) + Rabs (s03 A) + Rabs (s11 A) + Rabs (s12 A)
  + Rabs (s13 A) + Rabs (s22 A) + Rabs (s23 A) + Rabs (s33 A).

Lemma product_bound a x y n : x * x + y * y <= 2 * n -> Rabs (2 * a * (x * y)) <= Rabs a * (2 * n).
Proof.
  intro H. replace (2 * a * (x * y)) with (a * (2 * (x * y))) by ring.
  rewrite Rabs_mult. apply Rmult_le_compat_l; [apply Rabs_pos|].
  pose proof (Rle_0_sqr (x + y)) as P. pose proof (Rle_0_sqr (x - y)) as Q. unfold Rsqr in *.
  apply Rabs_le_between. lra.
Qed.

Lemma square_bound a x n : x * x <= n -> Rabs (a * (x * x)) <= Rabs a * (2 * n).
Proof.
  intro H. rewrite Rabs_mult. apply Rmult_le_compat_l; [apply Rabs_pos|].
  pose proof (Rle_0_sqr x) as P. unfold Rsqr in P. rewrite Rabs_pos_eq; lra.
Qed.

Lemma form_bound A q : Rabs (form A q) <= 2 * entries_bound A * qnorm2 q.
Proof.
  destruct A as [a b d e f g h i j k], q as [w x y z].
  set (n := qnorm2 (Quat w x y z)).
  assert (N : n = w * w + x * x + y * y + z * z) by reflexivity.
  assert (w * w <= n /\ x * x <= n /\ y * y <= n /\ z * z <= n) as (? & ? & ? & ?)
    by (rewrite N; repeat split; nra).
  assert (P : forall c u v, u * u <= n -> v * v <= n -> Rabs (2 * c * (u * v)) <= Rabs c * (2 * n))
    by (intros; apply product_bound; lra).
  assert (S : forall c u, u * u <= n -> Rabs (c * (u * u)) <= Rabs c * (2 * n))
    by (intros; apply square_bound; assumption).
  replace (form (Sym a b d e f g h i j k) (Quat w x y z)) with
    (a * (w * w) + f * (x * x) + i * (y * y) + k * (z * z) + 2 * b * (w * x) + 2 * d * (w * y)
     + 2 * e * (w * z) + 2 * g * (x * y) + 2 * h * (x * z) + 2 * j * (y * z))
    by (clear; by_forms).
  replace (2 * entries_bound (Sym a b d e f g h i j k) * n) with
    (Rabs a * (2 * n) + Rabs f * (2 * n) + Rabs i * (2 * n) + Rabs k * (2 * n)
     + Rabs b * (2 * n) + Rabs d * (2 * n) + Rabs e * (2 * n) + Rabs g * (2 * n)
     + Rabs h * (2 * n) + Rabs j * (2 * n)) by (unfold entries_bound; simpl; ring).
  repeat (eapply Rle_trans; [apply Rabs_triang | apply Rplus_le_compat]); auto.
Qed.

Lemma entries_bound_nonnegative A : 0 <= entries_bound A.
Proof. unfold entries_bound. repeat apply Rplus_le_le_0_compat; apply Rabs_pos. Qed.

Lemma quartic_maximum A : exists m, forall q, quartic A q <= quartic A m.
Proof.
  pose proof (entries_bound_nonnegative A) as E.
  set (b := 4 * entries_bound A + 1).
  destruct (maximum_of_lipschitz b (quartic A)) as [m [_ U]];
    [unfold b; lra | apply quartic_lipschitz; unfold b; lra |].
  exists m. intro q.
  destruct (Rle_dec (qnorm2 q) (b * b)) as [Hq | Hq].
  - apply U. destruct q as [w x y z]. unfold qnorm2, qdot in Hq; simpl in Hq.
    assert (0 < b) by (unfold b; lra).
    assert (B : forall v, v * v <= b * b -> within b v).
    { intros v Hv. unfold within. split; nra. }
    repeat split; simpl; apply B; nra.
  - apply Rnot_le_lt in Hq. apply Rle_trans with 0.
    + unfold quartic. pose proof (form_bound A q) as F. apply Rabs_le_between in F.
      assert (4 * entries_bound A <= qnorm2 q) by (unfold b in Hq; nra).
      pose proof (qnorm2_nonnegative q). nra.
    + replace 0 with (quartic A qzero) by (unfold quartic; by_forms).
      apply U. unfold b, in_box, within, qzero; simpl. lra.
Qed.

Lemma no_linear_term a b c d :
  (forall t, a * t + b * (t * t) + c * (t * t * t) + d * (t * t * t * t) <= 0) -> a <= 0.
Proof.
  intro H. apply Rnot_lt_le. intro Ha.
  set (s := Rabs b + Rabs c + Rabs d).
  assert (Hs : 0 <= s) by (unfold s; repeat apply Rplus_le_le_0_compat; apply Rabs_pos).
  set (t := a / (s + a)).
  assert (Ht : 0 < t) by (apply Rdiv_lt_0_compat; lra).
  assert (E : t * (s + a) = a) by (unfold t; field; lra).
  assert (t <= 1) by nra.
  specialize (H t).
  assert (Hb : - Rabs b <= b) by (apply (Rabs_le_between b (Rabs b)); right; reflexivity).
  assert (Hc : - Rabs c <= c) by (apply (Rabs_le_between c (Rabs c)); right; reflexivity).
  assert (Hd : - Rabs d <= d) by (apply (Rabs_le_between d (Rabs d)); right; reflexivity).
  pose proof (Rabs_pos b). pose proof (Rabs_pos c). pose proof (Rabs_pos d).
  assert (0 < t * t) by nra.
  assert (0 < t * t * t <= t * t) by nra.
  assert (0 < t * t * t * t <= t * t) by nra.
  assert (- Rabs b * (t * t) <= b * (t * t)) by nra.
  assert (- Rabs c * (t * t) <= c * (t * t * t)) by nra.
  assert (- Rabs d * (t * t) <= d * (t * t * t * t)) by nra.
  assert (a * t <= s * (t * t)) by (unfold s; lra).
  assert (s * (t * t) = t * a - t * t * a)
    by (replace (s * (t * t)) with (t * (t * (s + a)) - t * t * a) by ring; rewrite E; ring).
  assert (0 < t * t * a) by (apply Rmult_lt_0_compat; assumption). lra.
Qed.

Lemma quartic_stationary A m : (forall q, quartic A q <= quartic A m) -> eigen A (qnorm2 m) m.
Proof.
  intro U.
  assert (half : forall p, qdot p (apply A m) - qnorm2 m * qdot p m <= 0).
  { intro p. apply (no_linear_term _ (form A p / 2 - qnorm2 m * qnorm2 p / 2 - qdot m p * qdot m p)
                    (- qdot m p * qnorm2 p) (- qnorm2 p * qnorm2 p / 4)).
    intro t. specialize (U (qadd m (qscale t p))).
    assert (E : quartic A (qadd m (qscale t p)) - quartic A m =
      2 * ((qdot p (apply A m) - qnorm2 m * qdot p m) * t
           + (form A p / 2 - qnorm2 m * qnorm2 p / 2 - qdot m p * qdot m p) * (t * t)
           + (- qdot m p * qnorm2 p) * (t * t * t)
           + (- qnorm2 p * qnorm2 p / 4) * (t * t * t * t))).
    { unfold quartic, form, qnorm2. rewrite apply_add, apply_scale.
      rewrite !qdot_add, !qdot_add_right, !qdot_scale, !qdot_scale_right.
      rewrite (qdot_comm p m), (apply_symmetric A m p). field. }
    lra. }
  assert (zero : forall p, qdot p (qadd (apply A m) (qscale (- qnorm2 m) m)) = 0).
  { intro p. rewrite qdot_add_right, qdot_scale_right.
    pose proof (half p) as H1. pose proof (half (qscale (-1) p)) as H2.
    rewrite !qdot_scale in H2. lra. }
  set (r := qadd (apply A m) (qscale (- qnorm2 m) m)) in *.
  assert (Z : r = qzero) by (apply qnorm2_zero, zero).
  unfold eigen. transitivity (qadd r (qscale (qnorm2 m) m)).
  - unfold r. generalize (apply A m). intros. by_entries.
  - rewrite Z. generalize (qnorm2 m). intros. by_entries.
Qed.

(** A largest eigenvalue exists, with a unit eigenvector, and bounds the form. *)
Theorem top_eigenvector A :
  exists k u, unit u /\ eigen A k u /\ forall p, form A p <= k * qnorm2 p.
Proof.
  set (shift := 2 * entries_bound A + 1). set (B := sshift shift A).
  assert (positive : forall p, qnorm2 p <= form B p).
  { intro p. unfold B. rewrite form_shift. pose proof (form_bound A p) as F.
    apply Rabs_le_between in F. unfold shift. lra. }
  destruct (quartic_maximum B) as [m U]. pose proof (quartic_stationary B m U) as E.
  set (n := qnorm2 m) in *.
  assert (value : quartic B m = / 2 * (n * n)).
  { unfold quartic, form. rewrite E, qdot_scale_right. fold (qnorm2 m) n. field. }
  assert (top : forall p, unit p -> form B p <= n).
  { intros p Hp. pose proof (positive p) as P. rewrite Hp in P.
    specialize (U (qscale (sqrt (form B p)) p)). rewrite value in U.
    unfold quartic, qnorm2 in U. rewrite form_scale, qdot_scale, qdot_scale_right in U.
    fold (qnorm2 p) in U. rewrite Hp in U.
    replace (sqrt (form B p) * (sqrt (form B p) * 1)) with (form B p) in U
      by (rewrite Rmult_1_r, sqrt_sqrt; lra).
    rewrite sqrt_sqrt in U by lra.
    pose proof (qnorm2_nonnegative m) as N. change (qnorm2 m) with n in N. nra. }
  assert (Hn : 0 < n).
  { assert (unit (Quat 1 0 0 0)) as H1 by (unfold_quats; ring).
    pose proof (top _ H1) as T. pose proof (positive (Quat 1 0 0 0)) as P. rewrite H1 in P. lra. }
  assert (nonzero : m <> qzero).
  { intro Z. unfold n in Hn. rewrite Z in Hn. unfold_quats. lra. }
  assert (topB : forall p, form B p <= n * qnorm2 p).
  { intro p. destruct (quat_eq_dec p qzero) as [-> | Hp].
    - replace (form B qzero) with 0 by (clearbody B; clear; by_forms).
      replace (n * qnorm2 qzero) with 0 by (clearbody n; unfold_quats; ring). lra.
    - pose proof (top _ (normalised p Hp)) as T. apply qnorm2_positive in Hp.
      rewrite form_scale in T.
      assert (0 < sqrt (qnorm2 p)) by (apply sqrt_lt_R0; assumption).
      replace (/ sqrt (qnorm2 p) * / sqrt (qnorm2 p) * form B p) with (form B p / qnorm2 p) in T.
      + apply (Rmult_le_compat_r (qnorm2 p)) in T; [|lra].
        replace (form B p / qnorm2 p * qnorm2 p) with (form B p) in T by (field; lra). lra.
      + rewrite <- (sqrt_sqrt (qnorm2 p)) at 1 by lra. field. lra. }
  exists (n - shift), (qscale (/ sqrt n) m). split; [|split].
  - apply normalised, nonzero.
  - apply eigen_scale. unfold eigen in *. revert E. unfold B. rewrite apply_shift.
    generalize (apply A m). intros q E.
    transitivity (qadd (qadd q (qscale shift m)) (qscale (- shift) m)).
    + clearbody shift. clear. by_entries.
    + rewrite E. clearbody n shift. clear. by_entries.
  - intro p. specialize (topB p). unfold B in topB. rewrite form_shift in topB. lra.
Qed.
