(** Forces, torques and energies depend on the points through their moments only.

    Claimed, for any list of points of total weight other than 0 and any damping: the total force,
    the torque, both energies and the dissipation as functions of M, C, S and J; the potential is
    the objective. Not claimed: anything of how the body moves. *)

Require Import Reals Lra List.
From Certreg Require Import Vectors Clouds.
Open Scope R_scope.

(** ** Sums *)

Lemma sum_ext f g l : (forall p, f p = g p) -> sum f l = sum g l.
Proof. intro H. induction l; simpl; congruence. Qed.

Lemma sum_nonnegative f l : (forall p, In p l -> 0 <= f p) -> 0 <= sum f l.
Proof.
  induction l as [|p l IH]; simpl; intro H; [lra|].
  assert (0 <= f p) by (apply H; auto). assert (0 <= sum f l) by (apply IH; auto). lra.
Qed.

Lemma sum_map f h l : sum f (map h l) = sum (fun p => f (h p)) l.
Proof. induction l; simpl; congruence. Qed.

Lemma mass_centred l : mass (centred l) = mass l.
Proof. unfold mass, centred. rewrite sum_map. reflexivity. Qed.

Lemma first_moment_shifted (g : pair -> vec) h a l :
  (forall p, weight (h p) = weight p) -> (forall p, g (h p) = vsub (g p) a) ->
  vsum (fun p => vscale (weight p) (g p)) (map h l) =
  vsub (vsum (fun p => vscale (weight p) (g p)) l) (vscale (sum weight l) a).
Proof.
  intros Hw Hg. induction l as [|p l IH]; simpl.
  - by_components.
  - rewrite IH, Hw, Hg.
    generalize (vsum (fun p => vscale (weight p) (g p)) l) (sum weight l) (weight p) (g p).
    clear.
    by_components.
Qed.

Lemma shift_to_centre m (a : vec) : m <> 0 -> vsub a (vscale m (vscale (/ m) a)) = vzero.
Proof. intro. destruct a. unfold_vectors; simpl. f_equal; field; assumption. Qed.

Lemma sources_centred l : mass l <> 0 ->
  vsum (fun p => vscale (weight p) (source p)) (centred l) = vzero.
Proof.
  intro H. unfold centred.
  rewrite (first_moment_shifted source _ (centre source l)); [|reflexivity..].
  apply shift_to_centre, H.
Qed.

Lemma targets_centred l : mass l <> 0 ->
  vsum (fun p => vscale (weight p) (target p)) (centred l) = vzero.
Proof.
  intro H. unfold centred.
  rewrite (first_moment_shifted target _ (centre target l)); [|reflexivity..].
  apply shift_to_centre, H.
Qed.

(** ** The moments of a list, whatever they are *)

Definition moment0 l := sum weight l.
Definition moment_x l := vsum (fun p => vscale (weight p) (source p)) l.
Definition moment_y l := vsum (fun p => vscale (weight p) (target p)) l.
Definition moment_yx l := msum (fun p => mscale (weight p) (outer (target p) (source p))) l.
Definition moment_xx l := msum (fun p => mscale (weight p) (outer (source p) (source p))) l.
Definition moment_J l :=
  msum (fun p => mscale (- weight p) (mmul (hat (source p)) (hat (source p)))) l.
Definition moment_yy l := sum (fun p => weight p * norm2 (target p)) l.

Ltac generalize_sums l :=
  repeat match goal with
         | |- context [sum ?g l] => generalize (sum g l); intro
         | |- context [vsum ?g l] => generalize (vsum g l); intro
         | |- context [msum ?g l] => generalize (msum g l); intro
         end.
Ltac by_induction l :=
  unfold moment0, moment_x, moment_y, moment_yx, moment_xx, moment_J, moment_yy;
  induction l as [|p l IH]; cbn [sum vsum msum]; [ by_components | ];
  rewrite IH; clear IH; generalize_sums l; destruct p; by_components.

Lemma inertia_from_scatter l :
  moment_J l = msub (mscale (trace (moment_xx l)) mid) (moment_xx l).
Proof. by_induction l. Qed.

Lemma force_of_moments mu s l :
  vsum (point_force mu s) l =
  vsub (vscale 2 (vsub (vsub (moment_y l) (mvec (attitude s) (moment_x l)))
                       (vscale (moment0 l) (position s))))
       (vscale mu (vadd (mvec (attitude s) (cross (spin s) (moment_x l)))
                        (vscale (moment0 l) (velocity s)))).
Proof.
  destruct s as [c R v w]; unfold point_force, spring, stretch, point_velocity;
    cbn [position attitude velocity spin].
  by_induction l.
Qed.

(** With any matrix in the place of R^T R: for rotations it is the identity. *)
Lemma torque_of_moments mu s l :
  vsum (fun p => cross (source p) (mvec (transpose (attitude s)) (point_force mu s p))) l =
  let R := attitude s in let P := mmul (transpose R) R in
  let D := mmul (transpose R) (moment_yx l) in
  vsub
    (vsub (vscale 2 (vsub (vee (msub D (transpose D)))
                          (vee (msub (mmul P (moment_xx l)) (transpose (mmul P (moment_xx l)))))))
          (vscale 2 (cross (moment_x l) (mvec (transpose R) (position s)))))
    (vscale mu
       (vadd (cross (moment_x l) (mvec (transpose R) (velocity s)))
             (vsum (fun p => vscale (weight p) (cross (source p) (mvec P (cross (spin s) (source p)))))
                   l))).
Proof.
  destruct s as [c R v w]; unfold point_force, spring, stretch, point_velocity;
    cbn [position attitude velocity spin].
  by_induction l.
Qed.

Lemma damping_torque_of_moments w l :
  vsum (fun p => vscale (weight p) (cross (source p) (mvec mid (cross w (source p))))) l =
  mvec (moment_J l) w.
Proof. by_induction l. Qed.

Lemma transpose_madd A B : transpose (madd A B) = madd (transpose A) (transpose B).
Proof. by_components. Qed.

Lemma xx_symmetric l : transpose (moment_xx l) = moment_xx l.
Proof.
  unfold moment_xx. induction l as [|p l IH]; cbn [msum]; [by_components|].
  rewrite transpose_madd, IH. f_equal. by_components.
Qed.

Lemma potential_of_moments s l : rotation (attitude s) ->
  sum (fun p => spring p / 2 * norm2 (stretch s p)) l =
  moment0 l * norm2 (position s) + moment_yy l + trace (moment_xx l)
  - 2 * trace (mmul (transpose (attitude s)) (moment_yx l))
  - 2 * dot (position s) (vsub (moment_y l) (mvec (attitude s) (moment_x l))).
Proof.
  intros rotates.
  assert (E : forall p, spring p / 2 * norm2 (stretch s p) =
    weight p * (norm2 (vsub (target p) (position s)) + norm2 (source p)
                - 2 * dot (vsub (target p) (position s)) (mvec (attitude s) (source p)))).
  { intro p. rewrite <- (rotation_keeps_lengths _ (source p) rotates).
    unfold spring, stretch. generalize (mvec (attitude s) (source p)).
    intros [a b d]. destruct s as [[c1 c2 c3] R v w], p as [m x [y1 y2 y3]].
    unfold_vectors; simpl. field. }
  rewrite (sum_ext _ _ l E). clear rotates E.
  destruct s as [c R v w]; cbn [position attitude velocity spin]. by_induction l.
Qed.

Lemma kinetic_of_moments s l : rotation (attitude s) ->
  sum (fun p => weight p / 2 * norm2 (point_velocity s p)) l =
  moment0 l / 2 * norm2 (velocity s) + / 2 * quadratic (moment_J l) (spin s)
  + dot (velocity s) (mvec (attitude s) (cross (spin s) (moment_x l))).
Proof.
  intros rotates.
  assert (E : forall p, weight p / 2 * norm2 (point_velocity s p) =
    weight p * / 2 * (norm2 (velocity s) + norm2 (cross (spin s) (source p)))
    + weight p * dot (velocity s) (mvec (attitude s) (cross (spin s) (source p)))).
  { intro p. rewrite <- (rotation_keeps_lengths _ (cross (spin s) (source p)) rotates).
    unfold point_velocity. generalize (mvec (attitude s) (cross (spin s) (source p))).
    intros [a b d]. destruct s as [c R [a1 a2 a3] w], p as [m x y].
    unfold_vectors; simpl. field. }
  rewrite (sum_ext _ _ l E). clear rotates E. unfold Rdiv.
  destruct s as [c R v w]; cbn [position attitude velocity spin]. by_induction l.
Qed.

(** ** The theorems *)

(** J = - sum m [x~]^2 = tr(S) I - S. *)
Theorem inertia_is_trace_minus_scatter l :
  inertia l = msub (mscale (trace (scatter l)) mid) (scatter l).
Proof. apply inertia_from_scatter. Qed.

Lemma scatter_symmetric l : symmetric (scatter l).
Proof. apply xx_symmetric. Qed.

Lemma inertia_symmetric l : symmetric (inertia l).
Proof.
  unfold symmetric. rewrite inertia_is_trace_minus_scatter.
  pose proof (scatter_symmetric l) as H. unfold symmetric in H. revert H.
  generalize (scatter l). intros [a b c d e f g h i]. unfold_vectors. intro H.
  injection H as H1 H2 H3 H4 H5 H6. subst. f_equal; ring.
Qed.

(** f = - 2 M c - mu M v. *)
Theorem force_reduction mu l s : mass l <> 0 ->
  force mu l s = vadd (vscale (-2 * mass l) (position s)) (vscale (- mu * mass l) (velocity s)).
Proof.
  intro H. unfold force. rewrite force_of_moments. unfold moment_x, moment_y, moment0.
  fold (mass (centred l)). rewrite sources_centred, targets_centred, mass_centred by assumption.
  generalize (mass l). by_components.
Qed.

Definition spring_torque l R :=
  vscale 2 (vee (msub (mmul (transpose R) (cross_covariance l))
                      (mmul (transpose (cross_covariance l)) R))).

(** tau = 2 vee(R^T C - C^T R) - mu J omega. *)
Theorem torque_reduction mu l s : mass l <> 0 -> rotation (attitude s) ->
  torque mu l s = vsub (spring_torque l (attitude s)) (vscale mu (mvec (inertia l) (spin s))).
Proof.
  intros H rotates. unfold torque. rewrite torque_of_moments. simpl.
  destruct rotates as [-> _]. rewrite mmul_id_left, xx_symmetric, damping_torque_of_moments.
  unfold moment_x. rewrite sources_centred by assumption.
  unfold spring_torque. fold (cross_covariance l) (inertia l).
  change (moment_yx (centred l)) with (cross_covariance l).
  change (moment_J (centred l)) with (inertia l).
  rewrite transpose_mmul.
  generalize (moment_xx (centred l)) (inertia l) (cross_covariance l) (position s) (velocity s)
    (spin s) (attitude s). by_components.
Qed.

(** V_p = M |c|^2 + sum m |y~|^2 + tr S - 2 tr(R^T C). *)
Theorem potential_reduction l s : mass l <> 0 -> rotation (attitude s) ->
  potential l s =
  mass l * norm2 (position s) + sum (fun p => weight p * norm2 (target p)) (centred l)
  + trace (scatter l) - 2 * trace (mmul (transpose (attitude s)) (cross_covariance l)).
Proof.
  intros H rotates. unfold potential. rewrite potential_of_moments by assumption.
  unfold moment0, moment_x, moment_y. fold (mass (centred l)).
  rewrite sources_centred, targets_centred, mass_centred by assumption.
  change (moment_yy (centred l)) with (sum (fun p => weight p * norm2 (target p)) (centred l)).
  change (moment_yx (centred l)) with (cross_covariance l).
  change (moment_xx (centred l)) with (scatter l).
  generalize (sum (fun p => weight p * norm2 (target p)) (centred l)) (scatter l)
    (cross_covariance l) (mass l) (position s) (attitude s). by_components.
Qed.

(** V_k = M |v|^2 / 2 + omega^T J omega / 2. *)
Theorem kinetic_reduction l s : mass l <> 0 -> rotation (attitude s) ->
  kinetic l s = mass l / 2 * norm2 (velocity s) + / 2 * quadratic (inertia l) (spin s).
Proof.
  intros H rotates. unfold kinetic. rewrite kinetic_of_moments by assumption.
  unfold moment0, moment_x. fold (mass (centred l)).
  rewrite sources_centred, mass_centred by assumption.
  change (moment_J (centred l)) with (inertia l). unfold Rdiv.
  generalize (inertia l) (mass l) (velocity s) (spin s) (attitude s). by_components.
Qed.

(** mu sum m |v_i|^2 = mu M |v|^2 + mu omega^T J omega. *)
Theorem dissipation_reduction mu l s : mass l <> 0 -> rotation (attitude s) ->
  dissipated mu l s = mu * mass l * norm2 (velocity s) + mu * quadratic (inertia l) (spin s).
Proof.
  intros H rotates.
  transitivity (2 * mu * kinetic l s).
  - unfold dissipated, kinetic. generalize (centred l) as k.
    induction k as [|p k IH]; simpl; [ring|]. rewrite IH. field.
  - rewrite kinetic_reduction by assumption. field.
Qed.

(** The translation of the clouds as given that belongs to a position of the body's centre. *)
Definition translation l s :=
  vsub (vadd (centre target l) (position s)) (mvec (attitude s) (centre source l)).

(** V_p is the maximum-likelihood objective; here R need not be a rotation. *)
Theorem potential_is_objective l s :
  potential l s = objective l (attitude s) (translation l s).
Proof.
  unfold potential, objective, centred. rewrite sum_map. apply sum_ext.
  intro p. unfold spring, stretch, residual, translation; simpl.
  generalize (centre source l) (centre target l) (attitude s) (position s) (source p) (target p)
    (weight p). intros. open_vectors; unfold_vectors; simpl. field.
Qed.

(** Conversely every translation is that of one position. *)
Lemma every_translation l R t v w :
  translation l (State (vsub (vadd t (mvec R (centre source l))) (centre target l)) R v w) = t.
Proof.
  unfold translation; simpl. generalize (centre source l) (centre target l). by_components.
Qed.
