(** The motion of the damped body, point by point.

    Claimed, along any solution of the equations of motion on any open interval of time: a rotation
    stays a rotation; dV/dt = - sum mu m_i |v_i|^2, so that the total energy never rises; the same for
    the energy of the rotation alone.
    Not claimed: that solutions exist, that they converge (LaSalle), anything of a discretisation. *)

Require Import Reals Lra List.
From Coquelicot Require Import Coquelicot.
From Certreg Require Import Vectors Clouds Moments.
Open Scope R_scope.

Definition vec_derive (f : R -> vec) t d :=
  is_derive (fun t => v1 (f t)) t (v1 d) /\ is_derive (fun t => v2 (f t)) t (v2 d) /\
  is_derive (fun t => v3 (f t)) t (v3 d).
Definition mat_derive (f : R -> mat) t D :=
  (is_derive (fun t => m11 (f t)) t (m11 D) /\ is_derive (fun t => m12 (f t)) t (m12 D) /\
   is_derive (fun t => m13 (f t)) t (m13 D)) /\
  (is_derive (fun t => m21 (f t)) t (m21 D) /\ is_derive (fun t => m22 (f t)) t (m22 D) /\
   is_derive (fun t => m23 (f t)) t (m23 D)) /\
  (is_derive (fun t => m31 (f t)) t (m31 D) /\ is_derive (fun t => m32 (f t)) t (m32 D) /\
   is_derive (fun t => m33 (f t)) t (m33 D)).

(** The paper's differential equations at one time; forces and torques are sums over the points. *)
Definition moves mu l (s : R -> state) t :=
  vec_derive (fun t => position (s t)) t (velocity (s t)) /\
  mat_derive (fun t => attitude (s t)) t (mmul (attitude (s t)) (hat (spin (s t)))) /\
  exists a alpha,
    vec_derive (fun t => velocity (s t)) t a /\ vec_derive (fun t => spin (s t)) t alpha /\
    vscale (mass l) a = force mu l (s t) /\
    mvec (inertia l) alpha =
      vsub (torque mu l (s t)) (cross (spin (s t)) (mvec (inertia l) (spin (s t)))).

Definition open_interval (D : R -> Prop) :=
  (forall a b t, D a -> D b -> a <= t <= b -> D t) /\ forall t, D t -> locally t D.

Definition solution mu l (D : R -> Prop) s := open_interval D /\ forall t, D t -> moves mu l s t.

(** ** Derivatives of products *)

Lemma derive_value (f : R -> R) (t x y : R) : is_derive f t x -> x = y -> is_derive f t y.
Proof. intros H <-. exact H. Qed.

Lemma derive_ext (f g : R -> R) (t d : R) : (forall x, f x = g x) -> is_derive f t d ->
  is_derive g t d.
Proof. intros H Hf. apply (is_derive_ext f g t d); assumption. Qed.

Lemma derive_product (f g : R -> R) (t f' g' : R) : is_derive f t f' -> is_derive g t g' ->
  is_derive (fun t => f t * g t) t (f' * g t + f t * g').
Proof.
  intros Hf Hg. apply (is_derive_mult f g t f' g' Hf Hg). intros; apply Rmult_comm.
Qed.

Lemma derive_sum (f g : R -> R) (t f' g' : R) : is_derive f t f' -> is_derive g t g' ->
  is_derive (fun t => f t + g t) t (f' + g').
Proof. intros Hf Hg. apply (is_derive_plus f g t f' g' Hf Hg). Qed.

Lemma derive_multiple (k : R) (f : R -> R) (t f' : R) : is_derive f t f' ->
  is_derive (fun t => k * f t) t (k * f').
Proof.
  intro Hf. apply (derive_value _ _ (0 * f t + k * f')); [|ring].
  apply (derive_product (fun _ => k) f); [apply (is_derive_const (V := R_NormedModule)) | exact Hf].
Qed.

Lemma derive_constant (k : R) t : is_derive (fun _ : R => k) t 0.
Proof. apply (is_derive_const (V := R_NormedModule)). Qed.

(** By the shape of the function; [apply] alone would search. *)
Ltac differentiate :=
  match goal with
  | |- is_derive (fun x => @?f x + @?g x) _ _ => apply (derive_sum f g); differentiate
  | |- is_derive (fun x => @?f x * @?g x) _ _ =>
      first [ match f with fun _ => ?k => apply (derive_multiple k g) end
            | apply (derive_product f g) ]; differentiate
  | |- is_derive ?f _ _ =>
      first [ eassumption | match f with fun _ => ?k => apply (derive_constant k) end ]
  end.

Lemma dot_derive f g t f' g' : vec_derive f t f' -> vec_derive g t g' ->
  is_derive (fun t => dot (f t) (g t)) t (dot f' (g t) + dot (f t) g').
Proof.
  intros (F1 & F2 & F3) (G1 & G2 & G3). unfold dot.
  eapply derive_value;
    [differentiate | cbv beta; ring].
Qed.

Lemma mvec_derive A f t f' : vec_derive f t f' -> vec_derive (fun t => mvec A (f t)) t (mvec A f').
Proof.
  intros (F1 & F2 & F3). unfold vec_derive, mvec; cbn [v1 v2 v3].
  split; [|split]; differentiate.
Qed.

Lemma trace_derive C f t D : mat_derive f t D ->
  is_derive (fun t => trace (mmul (transpose (f t)) C)) t (trace (mmul (transpose D) C)).
Proof.
  intros ((A1 & A2 & A3) & (B1 & B2 & B3) & (D1 & D2 & D3)).
  apply (derive_ext (fun t =>
    m11 C * m11 (f t) + m12 C * m12 (f t) + m13 C * m13 (f t)
    + m21 C * m21 (f t) + m22 C * m22 (f t) + m23 C * m23 (f t)
    + m31 C * m31 (f t) + m32 C * m32 (f t) + m33 C * m33 (f t))).
  - intro x. generalize (f x). clear. intro A. destruct A, C. unfold_vectors. ring.
  - eapply derive_value.
    + differentiate.
    + destruct D, C. unfold_vectors. ring.
Qed.

(** ** What never rises *)

Lemma never_rises (f df : R -> R) a b : a <= b ->
  (forall t, a <= t <= b -> is_derive f t (df t)) -> (forall t, a <= t <= b -> df t <= 0) ->
  f b <= f a.
Proof.
  intros H Hf Hd.
  destruct (MVT_gen f a b df) as (c & Hc & E).
  - rewrite Rmin_left, Rmax_right by assumption. intros x Hx. apply Hf. lra.
  - rewrite Rmin_left, Rmax_right by assumption. intros x Hx.
    apply derivable_continuous_pt. exists (df x). apply is_derive_Reals, Hf, Hx.
  - rewrite Rmin_left, Rmax_right in Hc by assumption. specialize (Hd c Hc). nra.
Qed.

Lemma stays (f : R -> R) a b : (forall t, Rmin a b <= t <= Rmax a b -> is_derive f t 0) -> f a = f b.
Proof.
  intro H. destruct (Rle_dec a b) as [L | L].
  - rewrite Rmin_left, Rmax_right in H by assumption. apply Rle_antisym.
    + enough (- f b <= - f a) by lra.
      apply (never_rises (fun t => - f t) (fun _ => 0)); [assumption | | intros; lra].
      intros t Ht. apply (derive_value _ _ (- 0)); [|ring]. apply (is_derive_opp f t 0), H, Ht.
    + apply (never_rises f (fun _ => 0)); auto. intros; lra.
  - apply Rnot_le_lt in L. rewrite Rmin_right, Rmax_left in H by lra. apply Rle_antisym.
    + apply (never_rises f (fun _ => 0)); [lra | auto | intros; lra].
    + enough (- f a <= - f b) by lra.
      apply (never_rises (fun t => - f t) (fun _ => 0)); [lra | | intros; lra].
      intros t Ht. apply (derive_value _ _ (- 0)); [|ring]. apply (is_derive_opp f t 0), H, Ht.
Qed.

(** ** A rotation stays a rotation *)

Definition gram_defect R :=
  let E := msub (mmul (transpose R) R) mid in trace (mmul (transpose E) E).

Lemma gram_defect_zero R : gram_defect R = 0 <-> mmul (transpose R) R = mid.
Proof.
  unfold gram_defect. split.
  - generalize (mmul (transpose R) R). intros [a b c d e f g h i]. unfold_vectors. intro H.
    assert (S : forall x, 0 <= x * x) by (intro; nra).
    pose proof (S (a + -1 * 1)). pose proof (S (e + -1 * 1)). pose proof (S (i + -1 * 1)).
    pose proof (S (b + -1 * 0)). pose proof (S (c + -1 * 0)). pose proof (S (d + -1 * 0)).
    pose proof (S (f + -1 * 0)). pose proof (S (g + -1 * 0)). pose proof (S (h + -1 * 0)).
    assert (Z : forall x, x * x = 0 -> x = 0) by (intros x Hx; apply Rmult_integral in Hx; tauto).
    assert (a + -1 * 1 = 0) by (apply Z; lra). assert (e + -1 * 1 = 0) by (apply Z; lra).
    assert (i + -1 * 1 = 0) by (apply Z; lra). assert (b + -1 * 0 = 0) by (apply Z; lra).
    assert (c + -1 * 0 = 0) by (apply Z; lra). assert (d + -1 * 0 = 0) by (apply Z; lra).
    assert (f + -1 * 0 = 0) by (apply Z; lra). assert (g + -1 * 0 = 0) by (apply Z; lra).
    assert (h + -1 * 0 = 0) by (apply Z; lra). f_equal; lra.
  - intros ->. by_components.
Qed.

Lemma gram_derive f t D : mat_derive f t D ->
  mat_derive (fun t => mmul (transpose (f t)) (f t)) t
    (madd (mmul (transpose D) (f t)) (mmul (transpose (f t)) D)).
Proof.
  intros ((A1 & A2 & A3) & (B1 & B2 & B3) & (D1 & D2 & D3)).
  unfold mat_derive. cbn [mmul transpose madd m11 m12 m13 m21 m22 m23 m31 m32 m33].
  split; [|split]; (split; [|split]); (eapply derive_value; [differentiate | cbv beta; ring]).
Qed.

Lemma gram_defect_derive f t w : mat_derive f t (mmul (f t) (hat w)) ->
  is_derive (fun t => gram_defect (f t)) t 0.
Proof.
  intro H. apply gram_derive in H. unfold gram_defect.
  set (P := fun t => mmul (transpose (f t)) (f t)) in *.
  assert (E : P t = mmul (transpose (f t)) (f t)) by reflexivity.
  apply (derive_ext (fun t =>
    m11 (P t) * m11 (P t) + m12 (P t) * m12 (P t) + m13 (P t) * m13 (P t)
    + m21 (P t) * m21 (P t) + m22 (P t) * m22 (P t) + m23 (P t) * m23 (P t)
    + m31 (P t) * m31 (P t) + m32 (P t) * m32 (P t) + m33 (P t) * m33 (P t)
    + (-2 * (m11 (P t) + m22 (P t) + m33 (P t)) + 3))).
  - intro x. change (mmul (transpose (f x)) (f x)) with (P x). generalize (P x). clear. intros []. unfold_vectors. ring.
  - destruct H as ((A1 & A2 & A3) & (B1 & B2 & B3) & (D1 & D2 & D3)).
    eapply derive_value; [differentiate|]. rewrite E. clearbody P. clear.
    generalize (f t). intros []. destruct w. unfold_vectors. ring.
Qed.

Lemma det_derive f t w : mat_derive f t (mmul (f t) (hat w)) ->
  is_derive (fun t => det (f t)) t 0.
Proof.
  intros ((A1 & A2 & A3) & (B1 & B2 & B3) & (D1 & D2 & D3)).
  apply (derive_ext (fun t =>
    m11 (f t) * (m22 (f t) * m33 (f t) + -1 * (m23 (f t) * m32 (f t)))
    + (-1 * (m12 (f t) * (m21 (f t) * m33 (f t) + -1 * (m23 (f t) * m31 (f t))))
       + m13 (f t) * (m21 (f t) * m32 (f t) + -1 * (m22 (f t) * m31 (f t)))))).
  - intro x. generalize (f x). clear. intros []. unfold_vectors. ring.
  - eapply derive_value.
    + differentiate.
    + generalize (f t). intros []. destruct w. unfold_vectors. ring.
Qed.

(** R^T R = I and det R = 1 hold at all times where they hold at one. *)
Theorem rotations_stay_rotations mu l D s t0 t : solution mu l D s -> D t0 -> D t ->
  rotation (attitude (s t0)) -> rotation (attitude (s t)).
Proof.
  intros [[I _] M] H0 H [orthogonal unit_det].
  assert (inside : forall x, Rmin t0 t <= x <= Rmax t0 t -> D x).
  { intros x Hx. destruct (Rle_dec t0 t).
    - rewrite Rmin_left, Rmax_right in Hx by assumption. apply (I t0 t); assumption.
    - rewrite Rmin_right, Rmax_left in Hx by lra. apply (I t t0); assumption. }
  split.
  - apply gram_defect_zero. rewrite <- (proj2 (gram_defect_zero _) orthogonal). symmetry.
    apply (stays (fun t => gram_defect (attitude (s t)))). intros x Hx.
    destruct (M x (inside x Hx)) as (_ & A & _).
    apply (gram_defect_derive (fun t => attitude (s t)) x (spin (s x)) A).
  - rewrite <- unit_det. symmetry.
    apply (stays (fun t => det (attitude (s t)))). intros x Hx.
    destruct (M x (inside x Hx)) as (_ & A & _).
    apply (det_derive (fun t => attitude (s t)) x (spin (s x)) A).
Qed.

(** ** Energy *)

(** What the total energy is for rotations, by its moments. *)
Definition reduced_energy l s :=
  mass l / 2 * norm2 (velocity s) + / 2 * dot (spin s) (mvec (inertia l) (spin s))
  + (mass l * norm2 (position s)
     + (sum (fun p => weight p * norm2 (target p)) (centred l) + trace (scatter l))
     + -2 * trace (mmul (transpose (attitude s)) (cross_covariance l))).

Lemma energy_reduced l s : mass l <> 0 -> rotation (attitude s) -> energy l s = reduced_energy l s.
Proof.
  intros H rotates. unfold energy, reduced_energy.
  rewrite kinetic_reduction, potential_reduction by assumption. unfold quadratic. ring.
Qed.

(** The energy of the rotation alone. *)
Definition spin_energy l s :=
  / 2 * dot (spin s) (mvec (inertia l) (spin s))
  + -2 * trace (mmul (transpose (attitude s)) (cross_covariance l)).

Lemma power_of_springs l R w :
  2 * trace (mmul (transpose (mmul R (hat w))) (cross_covariance l)) = dot w (spring_torque l R).
Proof. unfold spring_torque. generalize (cross_covariance l). by_components. Qed.

Lemma symmetric_dot J a b : symmetric J -> dot a (mvec J b) = dot b (mvec J a).
Proof.
  intro H. rewrite dot_mvec. unfold symmetric in H. rewrite H. clear. by_components.
Qed.

Lemma spin_energy_derive mu l s t : mass l <> 0 -> rotation (attitude (s t)) -> moves mu l s t ->
  is_derive (fun t => spin_energy l (s t)) t (- mu * quadratic (inertia l) (spin (s t))).
Proof.
  intros H rotates (_ & A & a & alpha & _ & W & _ & E).
  pose proof (inertia_symmetric l) as SJ.
  eapply derive_value.
  - apply derive_sum.
    + apply derive_multiple, (dot_derive (fun t => spin (s t))
        (fun t => mvec (inertia l) (spin (s t))) t alpha (mvec (inertia l) alpha) W).
      apply mvec_derive, W.
    + apply derive_multiple, (trace_derive _ (fun t => attitude (s t)) t _ A).
  - rewrite (symmetric_dot _ alpha (spin (s t)) SJ), E.
    rewrite torque_reduction by assumption.
    replace (-2 * trace (mmul (transpose (mmul (attitude (s t)) (hat (spin (s t)))))
                              (cross_covariance l)))
      with (- dot (spin (s t)) (spring_torque l (attitude (s t))))
      by (rewrite <- power_of_springs; ring).
    generalize (spring_torque l (attitude (s t))) (inertia l) (spin (s t)). clear.
    intros. open_vectors. unfold_vectors. field.
Qed.

Lemma reduced_energy_derive mu l s t : mass l <> 0 -> rotation (attitude (s t)) -> moves mu l s t ->
  is_derive (fun t => reduced_energy l (s t)) t (- dissipated mu l (s t)).
Proof.
  intros H rotates M. pose proof (spin_energy_derive mu l s t H rotates M) as SE.
  destruct M as (X & _ & a & alpha & V & _ & F & _).
  apply (derive_ext (fun t => spin_energy l (s t) + (mass l / 2 * dot (velocity (s t)) (velocity (s t))
    + (mass l * dot (position (s t)) (position (s t))
       + (sum (fun p => weight p * norm2 (target p)) (centred l) + trace (scatter l)))))).
  - intro x. unfold spin_energy, reduced_energy, norm2. ring.
  - eapply derive_value.
    + apply derive_sum; [exact SE|]. apply derive_sum.
      * apply derive_multiple, (dot_derive (fun t => velocity (s t)) (fun t => velocity (s t)) t a a V V).
      * apply derive_sum; [|apply derive_constant].
        apply derive_multiple, (dot_derive (fun t => position (s t)) (fun t => position (s t)) t
          _ _ X X).
    + rewrite dissipation_reduction by assumption.
      assert (P : mass l / 2 * (dot a (velocity (s t)) + dot (velocity (s t)) a) =
                  dot (velocity (s t)) (vscale (mass l) a))
        by (generalize (mass l) (velocity (s t)); clear; intros; open_vectors; unfold_vectors; field).
      rewrite P, F, force_reduction by assumption.
      generalize (mass l) (velocity (s t)) (position (s t)) (quadratic (inertia l) (spin (s t))).
      clear. intros. open_vectors. unfold_vectors. ring.
Qed.

(** dV/dt is minus what damping takes away. *)
Theorem dissipation_identity mu l D s t : mass l <> 0 -> solution mu l D s -> D t ->
  (exists t0, D t0 /\ rotation (attitude (s t0))) ->
  is_derive (fun t => energy l (s t)) t (- dissipated mu l (s t)).
Proof.
  intros H S Ht (t0 & H0 & R0). destruct S as [[I O] M] eqn:E. clear E.
  apply (is_derive_ext_loc (fun t => reduced_energy l (s t))).
  - apply (filter_imp D); [|apply O, Ht]. intros x Hx. symmetry. apply energy_reduced; [assumption|].
    apply (rotations_stay_rotations mu l D s t0 x S); assumption.
  - apply reduced_energy_derive; [assumption | | apply M, Ht].
    apply (rotations_stay_rotations mu l D s t0 t S); assumption.
Qed.

Lemma dissipated_nonnegative mu l s : 0 <= mu -> (forall p, In p l -> 0 <= weight p) ->
  0 <= dissipated mu l s.
Proof.
  intros Hmu W. apply sum_nonnegative. intros p Hp. apply in_map_iff in Hp.
  destruct Hp as (r & <- & Hr). specialize (W r Hr). cbn [weight].
  apply Rmult_le_pos; [apply Rmult_le_pos; assumption | apply norm2_nonnegative].
Qed.

(** The paper's V never rises along any solution of the point-wise equations. *)
Theorem energy_never_rises mu l D s a b :
  0 <= mu -> (forall p, In p l -> 0 <= weight p) -> mass l <> 0 -> solution mu l D s ->
  rotation (attitude (s a)) -> D a -> D b -> a <= b -> energy l (s b) <= energy l (s a).
Proof.
  intros Hmu W H S Ra Ha Hb L.
  apply (never_rises (fun t => energy l (s t)) (fun t => - dissipated mu l (s t))); [assumption | |].
  - intros t Ht. apply (dissipation_identity mu l D); try assumption; [|exists a; auto].
    destruct S as [[I _] _]. apply (I a b); assumption.
  - intros t _. pose proof (dissipated_nonnegative mu l (s t) Hmu W). lra.
Qed.

(** The energy of the rotation alone, omega^T J omega / 2 - 2 tr(R^T C), never rises. *)
Theorem spin_energy_never_rises mu l D s a b :
  0 <= mu -> (forall x, 0 <= quadratic (inertia l) x) -> mass l <> 0 -> solution mu l D s ->
  rotation (attitude (s a)) -> D a -> D b -> a <= b -> spin_energy l (s b) <= spin_energy l (s a).
Proof.
  intros Hmu PJ H S Ra Ha Hb L.
  assert (inside : forall t, a <= t <= b -> D t).
  { intros t Ht. destruct S as [[I _] _]. apply (I a b); assumption. }
  apply (never_rises (fun t => spin_energy l (s t))
    (fun t => - mu * quadratic (inertia l) (spin (s t)))); [assumption | |].
  - intros t Ht. apply spin_energy_derive; [assumption | | apply S, inside, Ht].
    apply (rotations_stay_rotations mu l D s a t S); auto.
  - intros t _. specialize (PJ (spin (s t))). nra.
Qed.
