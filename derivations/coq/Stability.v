(** Linear stability of the damped motion.

    Claimed, for J positive definite and damping mu > 0: the polynomial of the linearised motion has
    as many roots with positive real part as G has negative squares; a balanced rotation that is not
    optimal has a growing mode. The linear motions are J p'' = - mu J p' - G p for the rotation, by
    [torque_linearised], and c'' = - mu c' - 2 c for the translation.
    Not claimed: Lyapunov's theorem, that linear instability is instability. *)

Require Import Reals Lra List Lia.
From Coquelicot Require Import Coquelicot.
From Certreg Require Import Vectors Quaternions Davenport Spectral Index Clouds Moments Equilibria
  Hessian.
Open Scope R_scope.

(** ** Polynomials with complex argument *)

Definition cdet (a b c d e f g h i : Complex.C) : Complex.C :=
  (a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g))%C.

(** det(z (z + mu) J + G). *)
Definition pencil mu J G (z : Complex.C) : Complex.C :=
  let s := (z * (z + RtoC mu))%C in
  let entry f := (s * RtoC (f J) + RtoC (f G))%C in
  cdet (entry m11) (entry m12) (entry m13) (entry m21) (entry m22) (entry m23)
       (entry m31) (entry m32) (entry m33).

(** The whole motion: (z^2 + mu z + 2)^3 of the translation times the pencil of the rotation. *)
Definition linearised mu J G (z : Complex.C) : Complex.C :=
  let t := (z * (z + RtoC mu) + RtoC 2)%C in (t * t * t * pencil mu J G z)%C.

Fixpoint from_roots (roots : list Complex.C) (z : Complex.C) : Complex.C :=
  match roots with nil => RtoC 1 | r :: rest => ((z - r) * from_roots rest z)%C end.

Definition grows (r : Complex.C) := if Rlt_dec 0 (fst r) then true else false.
Definition growing (roots : list Complex.C) := length (filter grows roots).

Lemma quadratic_roots mu g : 0 < mu -> exists r s,
  (forall z, (z * (z + RtoC mu) + RtoC g)%C = ((z - r) * (z - s))%C) /\
  growing (r :: s :: nil) = if Rlt_dec g 0 then 1%nat else 0%nat.
Proof.
  intro H. destruct (Rle_dec 0 (mu * mu - 4 * g)) as [D | D].
  - set (d := sqrt (mu * mu - 4 * g)). assert (E : d * d = mu * mu - 4 * g) by (apply sqrt_sqrt, D).
    assert (P : 0 <= d) by apply sqrt_pos.
    exists (RtoC ((- mu + d) / 2)), (RtoC ((- mu - d) / 2)). split.
    + intros [x y]. unfold RtoC. apply injective_projections; simpl;
        replace g with ((mu * mu - d * d) / 4) by lra; field.
    + unfold growing, grows. simpl.
      destruct (Rlt_dec 0 ((- mu + d) / 2)), (Rlt_dec 0 ((- mu - d) / 2)), (Rlt_dec g 0);
        simpl; try reflexivity; exfalso; nra.
  - set (d := sqrt (4 * g - mu * mu)).
    assert (E : d * d = 4 * g - mu * mu) by (apply sqrt_sqrt; lra).
    exists (- mu / 2, d / 2), (- mu / 2, - d / 2). split.
    + intros [x y]. unfold RtoC. apply injective_projections; simpl;
        replace g with ((mu * mu + d * d) / 4) by lra; field.
    + unfold growing, grows. simpl.
      destruct (Rlt_dec 0 (- mu / 2)); [exfalso; lra|].
      destruct (Rlt_dec g 0); simpl; [exfalso; nra | reflexivity].
Qed.

(** A cubic is known by four values. *)
Lemma cubic_coefficients a b c d a' b' c' d' :
  (forall s, a * s * s * s + b * s * s + c * s + d = a' * s * s * s + b' * s * s + c' * s + d') ->
  a = a' /\ b = b' /\ c = c' /\ d = d'.
Proof.
  intro H. pose proof (H 0). pose proof (H 1). pose proof (H (-1)). pose proof (H 2). lra.
Qed.

(** The coefficients of det(s J + G) other than det J and det G. *)
Definition mixed J G := trace (mmul (adjugate J) G).

Lemma det_expansion J G s :
  det (madd (mscale s J) G) =
  det J * s * s * s + mixed J G * s * s + mixed G J * s + det G.
Proof. unfold mixed. by_components. Qed.

Lemma pencil_expansion mu J G z :
  let s := (z * (z + RtoC mu))%C in
  pencil mu J G z =
  (RtoC (det J) * s * s * s + RtoC (mixed J G) * s * s + RtoC (mixed G J) * s + RtoC (det G))%C.
Proof.
  unfold pencil. cbv zeta. generalize (z * (z + RtoC mu))%C. intros [x y].
  destruct J, G. unfold mixed. unfold_vectors. unfold cdet, RtoC.
  apply injective_projections; simpl; ring.
Qed.

Lemma pencil_factors mu J G B g1 g2 g3 z :
  mmul (transpose B) (mmul J B) = mid -> mmul (transpose B) (mmul G B) = diag g1 g2 g3 ->
  pencil mu J G z =
  (RtoC (det J) * ((z * (z + RtoC mu) + RtoC g1) * (z * (z + RtoC mu) + RtoC g2)
                   * (z * (z + RtoC mu) + RtoC g3)))%C.
Proof.
  intros HJ HG. destruct (frame_invertible J B HJ) as (E & DB & DJ).
  assert (P : forall s, det (madd (mscale s J) G) = det J * ((s + g1) * (s + g2) * (s + g3))).
  { intro s.
    assert (F : det B * det B * det (madd (mscale s J) G) = (s + g1) * (s + g2) * (s + g3)).
    { transitivity (det (mmul (transpose B) (mmul (madd (mscale s J) G) B)));
        [rewrite !det_mmul, det_transpose; ring|].
      replace (mmul (transpose B) (mmul (madd (mscale s J) G) B)) with
        (madd (mscale s (mmul (transpose B) (mmul J B))) (mmul (transpose B) (mmul G B)))
        by (clear; by_components).
      rewrite HJ, HG. unfold diag. clear. by_components. }
    rewrite <- F. replace (det J * (det B * det B * det (madd (mscale s J) G)))
      with (det B * det B * det J * det (madd (mscale s J) G)) by ring.
    rewrite E. ring. }
  destruct (cubic_coefficients (det J) (mixed J G) (mixed G J) (det G) (det J)
    (det J * (g1 + g2 + g3)) (det J * (g1 * g2 + g1 * g3 + g2 * g3)) (det J * (g1 * g2 * g3)))
    as (_ & C2 & C1 & C0).
  { intro s. rewrite <- det_expansion, P. ring. }
  rewrite pencil_expansion, C2, C1, C0. generalize (z * (z + RtoC mu))%C (det J). clear.
  intros [x y] j. unfold RtoC. apply injective_projections; simpl; ring.
Qed.

Lemma from_roots_app a b z : from_roots (a ++ b) z = (from_roots a z * from_roots b z)%C.
Proof.
  induction a as [|r a IH]; cbn [from_roots app].
  - rewrite Cmult_1_l. reflexivity.
  - rewrite IH. apply Cmult_assoc.
Qed.

Lemma growing_app a b : growing (a ++ b) = (growing a + growing b)%nat.
Proof. unfold growing. rewrite filter_app, app_length. reflexivity. Qed.

(** Exactly index(G) roots lie in the right half plane, counted with multiplicity. *)
Theorem unstable_roots_are_the_index mu J G n :
  0 < mu -> symmetric J -> positive_definite J -> symmetric G -> index G n ->
  exists roots, length roots = 12%nat /\ growing roots = n /\ det J <> 0 /\
    forall z, linearised mu J G z = (RtoC (det J) * from_roots roots z)%C.
Proof.
  intros Hmu SJ PJ SG Hn.
  destruct (simultaneous_diagonalisation J G SJ PJ SG) as (B & g1 & g2 & g3 & HJ & HG).
  destruct (frame_diagonalises J G B g1 g2 g3 HJ HG) as (c1 & c2 & c3 & L).
  destruct (quadratic_roots mu g1 Hmu) as (r1 & s1 & E1 & N1).
  destruct (quadratic_roots mu g2 Hmu) as (r2 & s2 & E2 & N2).
  destruct (quadratic_roots mu g3 Hmu) as (r3 & s3 & E3 & N3).
  destruct (quadratic_roots mu 2 Hmu) as (r & s & E & N).
  exists ((r1 :: s1 :: nil) ++ (r2 :: s2 :: nil) ++ (r3 :: s3 :: nil)
          ++ (r :: s :: nil) ++ (r :: s :: nil) ++ (r :: s :: nil)).
  split; [reflexivity | split; [|split]].
  - rewrite !growing_app, N1, N2, N3, N. destruct (Rlt_dec 2 0); [exfalso; lra|].
    apply (index_unique G); [|assumption].
    exists ((c1, g1) :: (c2, g2) :: (c3, g3) :: nil). split; [assumption|].
    unfold negatives, is_negative. simpl.
    destruct (Rlt_dec g1 0), (Rlt_dec g2 0), (Rlt_dec g3 0); reflexivity.
  - apply (frame_invertible J B HJ).
  - intro z. unfold linearised. rewrite (pencil_factors mu J G B g1 g2 g3 z HJ HG).
    rewrite !from_roots_app. cbn [from_roots]. rewrite !Cmult_1_r, E, E1, E2, E3.
    generalize (z - r)%C (z - s)%C (z - r1)%C (z - s1)%C (z - r2)%C (z - s2)%C (z - r3)%C
      (z - s3)%C (RtoC (det J)). intros. ring.
Qed.

(** At every equilibrium: as many unstable eigenvalues as eigenvalues of K above its own. *)
Theorem unstable_roots_at_equilibrium mu l k u R :
  0 < mu -> positive_definite (inertia l) ->
  spectral (davenport (cross_covariance l)) k u -> balanced (cross_covariance l) R ->
  exists j roots, trace (mmul (transpose R) (cross_covariance l)) = k j /\
    length roots = 12%nat /\ growing roots = above k j /\ det (inertia l) <> 0 /\
    forall z, linearised mu (inertia l) (hessian (cross_covariance l) R) z =
              (RtoC (det (inertia l)) * from_roots roots z)%C.
Proof.
  intros Hmu PJ S B. pose proof (inertia_symmetric l) as SJ.
  destruct (morse_index _ k u R S B) as (j & E & I).
  destruct (unstable_roots_are_the_index mu _ _ _ Hmu SJ PJ (hessian_symmetric _ _) I)
    as (roots & L & N & D & F).
  exists j, roots. auto.
Qed.

(** ** Growing modes *)

(** t |-> exp(rate t) a solves J p'' = - mu J p' - G p. *)
Definition growing_mode mu J G rate a :=
  0 < rate /\ a <> vzero /\
  vadd (vscale (rate * (rate + mu)) (mvec J a)) (mvec G a) = vzero.

Lemma negative_square_grows mu J G g a : 0 < mu -> g < 0 -> a <> vzero ->
  mvec G a = vscale g (mvec J a) -> exists rate, growing_mode mu J G rate a.
Proof.
  intros Hmu Hg Ha E. set (d := sqrt (mu * mu - 4 * g)).
  assert (D : d * d = mu * mu - 4 * g) by (apply sqrt_sqrt; nra).
  assert (P : 0 <= d) by apply sqrt_pos. assert (mu < d) by nra.
  exists ((- mu + d) / 2). split; [lra | split; [assumption|]].
  rewrite E. replace ((- mu + d) / 2 * ((- mu + d) / 2 + mu)) with (- g) by (clear - D; field_simplify; lra).
  generalize (mvec J a). clear. by_components.
Qed.

(** A positive index gives a real growing mode of J p'' = - mu J p' - G p. *)
Theorem positive_index_grows mu J G n :
  0 < mu -> symmetric J -> positive_definite J -> symmetric G -> index G n -> n <> 0%nat ->
  exists rate a, growing_mode mu J G rate a.
Proof.
  intros Hmu SJ PJ SG Hn H.
  destruct (simultaneous_diagonalisation J G SJ PJ SG) as (B & g1 & g2 & g3 & HJ & HG).
  destruct (frame_diagonalises J G B g1 g2 g3 HJ HG) as (c1 & c2 & c3 & L).
  destruct (frame_invertible J B HJ) as (_ & DB & _).
  assert (I : index G (negatives ((c1, g1) :: (c2, g2) :: (c3, g3) :: nil)))
    by (eexists; split; [exact L | reflexivity]).
  assert (step : forall x g, x <> vzero -> mvec (diag g1 g2 g3) x = vscale g x -> g < 0 ->
                 exists rate a, growing_mode mu J G rate a).
  { intros x g Hx E Hg.
    destruct (negative_square_grows mu J G g (mvec B x) Hmu Hg) as [rate M].
    - intro Z. apply Hx, (kernel_trivial B); assumption.
    - apply (frame_mode J G B g1 g2 g3 x HJ HG g E).
    - exists rate, (mvec B x). exact M. }
  destruct (Rlt_dec g1 0).
  { apply (step (Vec 1 0 0) g1); [unfold vzero; intro Z; injection Z; lra | | assumption].
    unfold diag. by_components. }
  destruct (Rlt_dec g2 0).
  { apply (step (Vec 0 1 0) g2); [unfold vzero; intro Z; injection Z; lra | | assumption].
    unfold diag. by_components. }
  destruct (Rlt_dec g3 0).
  { apply (step (Vec 0 0 1) g3); [unfold vzero; intro Z; injection Z; lra | | assumption].
    unfold diag. by_components. }
  exfalso. apply H. rewrite <- (index_unique _ _ _ I Hn). unfold negatives, is_negative. simpl.
  destruct (Rlt_dec g1 0), (Rlt_dec g2 0), (Rlt_dec g3 0); try contradiction. reflexivity.
Qed.

(** Every equilibrium that is not optimal has a growing mode. *)
Theorem spurious_equilibria_have_a_growing_mode mu l R :
  0 < mu -> positive_definite (inertia l) -> spurious (cross_covariance l) R ->
  exists rate a, growing_mode mu (inertia l) (hessian (cross_covariance l) R) rate a.
Proof.
  intros Hmu PJ [B N]. destruct (spectral_theorem (davenport (cross_covariance l))) as (k & u & S).
  destruct (morse_index _ k u R S B) as (j & _ & I).
  apply (positive_index_grows mu _ _ _ Hmu (inertia_symmetric l) PJ (hessian_symmetric _ _) I).
  intro Z. apply N, (optimal_iff_index_zero _ _ B). rewrite <- Z. exact I.
Qed.
