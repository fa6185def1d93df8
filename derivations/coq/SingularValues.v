(** The special singular values d1 >= d2 >= |d3| of C, and the row of the table that C is in.

    Claimed: with d_i so defined from the eigenvalues of Davenport's matrix, those are d1 + d2 + d3,
    d1 - d2 - d3, - d1 + d2 - d3, - d1 - d2 + d3; the d_i^2 are the roots of the characteristic
    polynomial of C^T C and d1 d2 d3 = det C; the multiplicities follow without roots from polynomials
    in the entries of C. *)

Require Import Reals Lra List Psatz.
From Certreg Require Import Vectors Quaternions Davenport Spectral Equilibria.
Open Scope R_scope.

Definition gram C := mmul (transpose C) C.

(** Elementary symmetric functions of the eigenvalues of C^T C; the third is (det C)^2. *)
Definition sigma1 C := trace (gram C).
Definition sigma2 C := (trace (gram C) * trace (gram C) - trace (mmul (gram C) (gram C))) / 2.

Definition d1 (k : four -> R) := (k I1 + k I2) / 2.
Definition d2 (k : four -> R) := (k I1 + k I3) / 2.
Definition d3 (k : four -> R) := (k I1 + k I4) / 2.

Lemma eigenvalues_sum_to_zero C k u : spectral (davenport C) k u ->
  sum4 k = 0.
Proof.
  intro S. rewrite (sum_of_eigenvalues _ k u S). apply davenport_traceless.
Qed.

Lemma apply_twice C k u q i : spectral (davenport C) k u ->
  qdot (apply (davenport C) (apply (davenport C) q)) (u i) = k i * k i * qdot q (u i).
Proof.
  intro S. rewrite !(apply_component _ k u _ i S). ring.
Qed.

Lemma sum_of_squares C k u : spectral (davenport C) k u ->
  sum4 (fun i => k i * k i) = 4 * sigma1 C.
Proof.
  intro S. rewrite <- (sum_of_products u (apply (davenport C)) (apply (davenport C)) k k (basis _ _ _ S));
    [| intros; apply (apply_component _ k u _ _ S) ..].
  unfold sigma1, gram, e1, e2, e3, e4. clear. by_forms.
Qed.

Lemma sum_of_cubes C k u : spectral (davenport C) k u ->
  sum4 (fun i => k i * (k i * k i)) = 24 * det C.
Proof.
  intro S. rewrite <- (sum_of_products u (apply (davenport C))
    (fun q => apply (davenport C) (apply (davenport C) q)) k (fun i => k i * k i) (basis _ _ _ S));
    [| intros; apply (apply_component _ k u _ _ S) | intros; apply (apply_twice _ k u _ _ S)].
  unfold e1, e2, e3, e4. clear. by_forms.
Qed.

Lemma sum_of_fourth_powers C k u : spectral (davenport C) k u ->
  sum4 (fun i => (k i * k i) * (k i * k i)) = 4 * (sigma1 C * sigma1 C) + 16 * sigma2 C.
Proof.
  intro S. rewrite <- (sum_of_products u (fun q => apply (davenport C) (apply (davenport C) q))
    (fun q => apply (davenport C) (apply (davenport C) q)) (fun i => k i * k i)
    (fun i => k i * k i) (basis _ _ _ S)); [| intros; apply (apply_twice _ k u _ _ S) ..].
  unfold sigma2, sigma1, gram, e1, e2, e3, e4. clear. destruct C. unfold_forms. field.
Qed.

(** The eigenvalues of K are d1 + d2 + d3, d1 - d2 - d3, - d1 + d2 - d3, - d1 - d2 + d3. *)
Theorem eigenvalues_from_singular_values C k u : spectral (davenport C) k u ->
  k I1 = d1 k + d2 k + d3 k /\ k I2 = d1 k - d2 k - d3 k /\
  k I3 = - d1 k + d2 k - d3 k /\ k I4 = - d1 k - d2 k + d3 k.
Proof.
  intro S. pose proof (eigenvalues_sum_to_zero C k u S) as Z. unfold sum4 in Z. unfold d1, d2, d3. lra.
Qed.

(** d1 >= d2 >= |d3|. *)
Theorem singular_values_ordered C k u : spectral (davenport C) k u ->
  Rabs (d3 k) <= d2 k <= d1 k.
Proof.
  intro S. pose proof (eigenvalues_sum_to_zero C k u S) as Z. unfold sum4 in Z.
  destruct (order _ _ _ S) as (D1 & D2 & D3).
  unfold d1, d2, d3. split; [apply Rabs_le; lra | lra].
Qed.

(** The symmetric functions of the d_i^2, and d1 d2 d3, are polynomials in the entries of C. *)
Theorem singular_values_symmetric_functions C k u : spectral (davenport C) k u ->
  sigma1 C = d1 k * d1 k + d2 k * d2 k + d3 k * d3 k /\
  sigma2 C = d1 k * d1 k * (d2 k * d2 k) + d1 k * d1 k * (d3 k * d3 k)
             + d2 k * d2 k * (d3 k * d3 k) /\
  det C = d1 k * d2 k * d3 k.
Proof.
  intro S. pose proof (sum_of_squares C k u S) as P2. pose proof (sum_of_cubes C k u S) as P3.
  pose proof (sum_of_fourth_powers C k u S) as P4.
  destruct (eigenvalues_from_singular_values C k u S) as (E1 & E2 & E3 & E4).
  unfold sum4 in *. rewrite E1, E2, E3, E4 in P2, P3, P4.
  generalize dependent (d1 k). generalize dependent (d2 k). generalize dependent (d3 k). intros.
  repeat split; [lra | | lra].
  match goal with |- _ = ?x * ?x * (?y * ?y) + _ + _ * (?z * ?z) =>
    assert (Q : sigma1 C = x * x + y * y + z * z) by lra end.
  rewrite Q in P4. lra.
Qed.

(** The characteristic polynomial of C^T C. *)
Lemma gram_characteristic C x :
  det (msub (mscale x mid) (gram C)) =
  x * x * x - sigma1 C * (x * x) + sigma2 C * x - det C * det C.
Proof. unfold sigma1, sigma2, gram. destruct C. unfold_vectors. field. Qed.

(** The d_i^2 are the eigenvalues of C^T C, with multiplicity: the |d_i| are its singular values. *)
Theorem squares_are_eigenvalues_of_gram C k u x : spectral (davenport C) k u ->
  det (msub (mscale x mid) (gram C)) =
  (x - d1 k * d1 k) * (x - d2 k * d2 k) * (x - d3 k * d3 k).
Proof.
  intro S. rewrite gram_characteristic. destruct (singular_values_symmetric_functions C k u S) as (-> & -> & ->). ring.
Qed.

(** The optimum is unique just where d2 + d3 > 0. *)
Theorem unique_iff_positive_margin C k u : spectral (davenport C) k u ->
  k I2 < k I1 <-> 0 < d2 k + d3 k.
Proof.
  intro S. pose proof (eigenvalues_sum_to_zero C k u S) as Z. unfold sum4 in Z. unfold d2, d3. split; lra.
Qed.

(** ** The decision *)

(** Discriminant of the characteristic polynomial of C^T C, and which of two roots is double. *)
Definition discriminant (e f g : R) :=
  e * e * (f * f) - 4 * (f * f * f) - 4 * (e * e * e) * g + 18 * (e * f * g) - 27 * (g * g).
Definition side (e f g : R) := 2 * (e * e * e) - 9 * (e * f) + 27 * g.

Definition decide (e f D : R) : list nat :=
  if Req_EM_T (discriminant e f (D * D)) 0 then
    if Req_EM_T f 0 then (if Req_EM_T e 0 then 4 :: nil else 2 :: 2 :: nil)%nat
    else if Req_EM_T (side e f (D * D)) 0
         then (if Rlt_dec 0 D then 1 :: 3 :: nil else 3 :: 1 :: nil)%nat
         else if Rlt_dec (side e f (D * D)) 0 then (1 :: 2 :: 1 :: nil)%nat
         else (if Rlt_dec 0 D then 1 :: 1 :: 2 :: nil else 2 :: 1 :: 1 :: nil)%nat
  else (1 :: 1 :: 1 :: 1 :: nil)%nat.

Lemma discriminant_of_roots a b c :
  discriminant (a + b + c) (a * b + a * c + b * c) (a * b * c) =
  (a - b) * (a - c) * (b - c) * ((a - b) * (a - c) * (b - c)).
Proof. unfold discriminant. ring. Qed.

Lemma side_of_roots a b :
  side (a + a + b) (a * a + a * b + a * b) (a * a * b) = 2 * ((b - a) * (b - a) * (b - a)).
Proof. unfold side. ring. Qed.

(** The multiplicities of d1 + d2 + d3, ... for d1 >= d2 >= |d3|, from polynomials in the d_i. *)
Definition pattern_of_values x y z : list nat :=
  match Req_EM_T (y + z) 0, Req_EM_T x y, Req_EM_T y z with
  | right _, right _, right _ => 1 :: 1 :: 1 :: 1 :: nil
  | right _, left _, right _ => 1 :: 2 :: 1 :: nil
  | right _, right _, left _ => 1 :: 1 :: 2 :: nil
  | right _, left _, left _ => 1 :: 3 :: nil
  | left _, right _, right _ => 2 :: 1 :: 1 :: nil
  | left _, left _, right _ => 3 :: 1 :: nil
  | left _, right _, left _ => 2 :: 2 :: nil
  | left _, left _, left _ => 4 :: nil
  end%nat.

Lemma cube_sign t : (0 < t -> 0 < t * t * t) /\ (t < 0 -> t * t * t < 0).
Proof.
  split; intro H.
  - repeat apply Rmult_lt_0_compat; assumption.
  - assert (0 < t * t) by nra. nra.
Qed.

Ltac settle :=
  repeat match goal with
  | |- context [Req_EM_T ?x ?y] => destruct (Req_EM_T x y); try (exfalso; lra)
  | |- context [Rlt_dec ?x ?y] => destruct (Rlt_dec x y); try (exfalso; lra)
  end; try reflexivity.

Lemma decide_from_values x y z : - y <= z <= y -> y <= x ->
  decide (x * x + y * y + z * z) (x * x * (y * y) + x * x * (z * z) + y * y * (z * z)) (x * y * z)
  = pattern_of_values x y z.
Proof.
  intros Hz Hy. unfold decide.
  replace (x * y * z * (x * y * z)) with (x * x * (y * y) * (z * z)) by ring.
  rewrite discriminant_of_roots.
  destruct (Req_dec x y) as [E | N].
  - subst y. replace (x * x - x * x) with 0 by ring.
    rewrite !Rmult_0_l. rewrite side_of_roots.
    destruct (Req_dec x 0) as [Z | X].
    + subst x. assert (z = 0) by lra. subst z.
      replace (0 * 0 * (0 * 0) + 0 * 0 * (0 * 0) + 0 * 0 * (0 * 0)) with 0 by ring.
      replace (0 * 0 + 0 * 0 + 0 * 0) with 0 by ring. unfold pattern_of_values. settle.
    + assert (X0 : 0 < x) by lra. assert (F : 0 < x * x) by nra.
      assert (FF : 0 < x * x * (x * x)) by nra.
      assert (0 <= x * x * (z * z)) by (apply Rmult_le_pos; nra).
      destruct (Req_dec z x) as [-> | A].
      * replace (x * x - x * x) with 0 by ring. rewrite !Rmult_0_l, !Rmult_0_r.
        assert (0 < x * x * x) by nra. unfold pattern_of_values. settle.
      * destruct (Req_dec z (- x)) as [-> | B].
        -- replace (- x * - x - x * x) with 0 by ring. rewrite !Rmult_0_l, !Rmult_0_r.
           assert (0 < x * x * x) by nra. assert (x * x * - x < 0) by nra.
           unfold pattern_of_values. settle.
        -- assert (z * z - x * x < 0) by nra.
           pose proof (proj2 (cube_sign (z * z - x * x)) H0) as Q.
           unfold pattern_of_values. settle.
  - assert (XY : y < x) by lra. assert (P : 0 < x * x - y * y) by nra.
    destruct (Req_dec y z) as [E | A].
    + subst z. replace (y * y - y * y) with 0 by ring. rewrite !Rmult_0_r.
      replace (x * x + y * y + y * y) with (y * y + y * y + x * x) by ring.
      replace (x * x * (y * y) + x * x * (y * y) + y * y * (y * y))
        with (y * y * (y * y) + y * y * (x * x) + y * y * (x * x)) by ring.
      replace (x * x * (y * y) * (y * y)) with (y * y * (y * y) * (x * x)) by ring.
      rewrite side_of_roots.
      pose proof (proj1 (cube_sign (x * x - y * y)) P) as Q.
      destruct (Req_dec y 0) as [-> | Y].
      * replace (0 * 0 * (0 * 0) + 0 * 0 * (x * x) + 0 * 0 * (x * x)) with 0 by ring.
        assert (0 < 0 * 0 + 0 * 0 + x * x) by nra. unfold pattern_of_values. settle.
      * assert (0 < y) by lra. assert (0 < y * y) by nra.
        assert (0 < y * y * (x * x)) by nra. assert (0 < y * y * (y * y)) by nra.
        assert (0 < x * y * y) by nra. unfold pattern_of_values. settle.
    + destruct (Req_dec (y + z) 0) as [E | B].
      * assert (z = - y) by lra. subst z.
        replace (- y * - y) with (y * y) by ring.
        replace (y * y - y * y) with 0 by ring. rewrite !Rmult_0_r.
        replace (x * x + y * y + y * y) with (y * y + y * y + x * x) by ring.
        replace (x * x * (y * y) + x * x * (y * y) + y * y * (y * y))
          with (y * y * (y * y) + y * y * (x * x) + y * y * (x * x)) by ring.
        replace (x * x * (y * y) * (y * y)) with (y * y * (y * y) * (x * x)) by ring.
        rewrite side_of_roots.
        pose proof (proj1 (cube_sign (x * x - y * y)) P) as Q.
        assert (0 < y) by lra. assert (0 < y * y) by nra.
        assert (0 < y * y * (x * x)) by nra. assert (0 < y * y * (y * y)) by nra.
        assert (x * y * - y < 0) by nra. unfold pattern_of_values. settle.
      * assert (V : 0 < y * y - z * z) by nra.
        assert (W : 0 < x * x - z * z) by nra.
        assert (U : 0 < (x * x - y * y) * (x * x - z * z) * (y * y - z * z))
          by (repeat apply Rmult_lt_0_compat; assumption).
        assert (0 < (x * x - y * y) * (x * x - z * z) * (y * y - z * z)
                    * ((x * x - y * y) * (x * x - z * z) * (y * y - z * z)))
          by (apply Rmult_lt_0_compat; assumption).
        unfold pattern_of_values. settle.
Qed.

(** The multiplicities, decided without roots. *)
Theorem pattern_decided C k u : spectral (davenport C) k u ->
  pattern k = decide (sigma1 C) (sigma2 C) (det C).
Proof.
  intro S. destruct (singular_values_symmetric_functions C k u S) as (-> & -> & ->).
  destruct (singular_values_ordered C k u S) as [A B].
  assert (Z : - d2 k <= d3 k <= d2 k) by (split; [|]; unfold Rabs in A; destruct Rcase_abs; lra).
  rewrite decide_from_values by assumption.
  destruct (eigenvalues_from_singular_values C k u S) as (E1 & E2 & E3 & E4).
  unfold pattern, pattern_of_values.
  destruct (Req_EM_T (k I1) (k I2)), (Req_EM_T (d2 k + d3 k) 0); try (exfalso; lra);
    destruct (Req_EM_T (k I2) (k I3)), (Req_EM_T (d1 k) (d2 k)); try (exfalso; lra);
    destruct (Req_EM_T (k I3) (k I4)), (Req_EM_T (d2 k) (d3 k)); try (exfalso; lra);
    reflexivity.
Qed.
