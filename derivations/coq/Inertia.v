(** When the inertia is positive definite: three points that are not on a line.

    Claimed, for weights that are not negative and not all zero: a^T J a is the sum of w |a x x~|^2,
    and J is positive definite just where three source points of positive weight are not collinear.
    Not claimed: how well conditioned J is. *)

Require Import Reals Lra List.
From Certreg Require Import Vectors Clouds Moments.
Open Scope R_scope.

(** Three source points of positive weight that are not on a line. *)
Definition not_collinear l :=
  exists p q r, (In p l /\ 0 < weight p) /\ (In q l /\ 0 < weight q) /\ (In r l /\ 0 < weight r) /\
    cross (vsub (source q) (source p)) (vsub (source r) (source p)) <> vzero.

Lemma quadratic_msum (f : pair -> mat) a l :
  quadratic (msum f l) a = sum (fun p => quadratic (f p) a) l.
Proof.
  induction l as [|p l IH]; simpl; [clear; by_components|]. rewrite <- IH.
  generalize (f p) (msum f l). clear. by_components.
Qed.

(** a^T J a = sum w |a x x~|^2. *)
Theorem inertia_form l a :
  quadratic (inertia l) a = sum (fun p => weight p * norm2 (cross a (source p))) (centred l).
Proof.
  unfold inertia. rewrite quadratic_msum. apply sum_ext. intros [w x y]. simpl. clear.
  by_components.
Qed.

Lemma norm2_nonnegative a : 0 <= norm2 a.
Proof. destruct a. unfold_vectors. simpl. nra. Qed.

Lemma norm2_zero a : norm2 a = 0 -> a = vzero.
Proof.
  destruct a as [x y z]. unfold_vectors. simpl. intro H.
  assert (x = 0) by nra. assert (y = 0) by nra. assert (z = 0) by nra. congruence.
Qed.

Lemma sum_zero f l : (forall p, In p l -> 0 <= f p) -> sum f l = 0 -> forall p, In p l -> f p = 0.
Proof.
  induction l as [|p l IH]; simpl; intros N Z q; [tauto|].
  assert (0 <= f p) by (apply N; auto).
  assert (0 <= sum f l) by (apply sum_nonnegative; auto).
  intros [<- | I]; [lra|]. apply IH; auto. lra.
Qed.

Lemma sum_of_zeros f l : (forall p, In p l -> f p = 0) -> sum f l = 0.
Proof.
  induction l as [|p l IH]; simpl; intro Z; [reflexivity|].
  rewrite Z by auto. rewrite IH by auto. ring.
Qed.

(** Over the cloud as given. *)
Lemma inertia_form_given l a : quadratic (inertia l) a =
  sum (fun p => weight p * norm2 (cross a (vsub (source p) (centre source l)))) l.
Proof. rewrite inertia_form. unfold centred. apply sum_map. Qed.

(** What lies on one line with b, lies on it with the centre. *)
Lemma centre_on_line l a b : mass l <> 0 ->
  (forall p, In p l -> weight p = 0 \/ cross a (vsub (source p) b) = vzero) ->
  cross a (vsub (centre source l) b) = vzero.
Proof.
  intros M H.
  assert (S : cross a (vsub (vsum (fun p => vscale (weight p) (source p)) l)
                            (vscale (mass l) b)) = vzero).
  { clear M. unfold mass. induction l as [|p l IH]; simpl; [clear; by_components|].
    specialize (IH ltac:(intros; apply H; simpl; auto)).
    assert (P : vscale (weight p) (cross a (vsub (source p) b)) = vzero).
    { destruct (H p) as [-> | ->]; [simpl; auto|clear; by_components..]. }
    transitivity (vadd (vscale (weight p) (cross a (vsub (source p) b)))
      (cross a (vsub (vsum (fun p => vscale (weight p) (source p)) l) (vscale (sum weight l) b)))).
    - generalize (vsum (fun p => vscale (weight p) (source p)) l) (sum weight l) (weight p)
        (source p). clear. by_components.
    - rewrite IH, P. clear. by_components. }
  unfold centre. set (x := vsum _ l) in *. clearbody x.
  transitivity (vscale (/ mass l) (cross a (vsub x (vscale (mass l) b)))).
  - generalize dependent (mass l). intros m Hm _. destruct a, b, x. unfold_vectors.
    f_equal; field; assumption.
  - rewrite S. clear. by_components.
Qed.

(** All differences along one a that is not 0: no three points span a triangle. *)
Lemma parallel a u v : a <> vzero -> cross a u = vzero -> cross a v = vzero -> cross u v = vzero.
Proof.
  intros A U V.
  assert (N : norm2 a <> 0) by (intro E; apply A, norm2_zero, E).
  assert (along : forall x, cross a x = vzero -> vscale (norm2 a) x = vscale (dot a x) a).
  { intros x X.
    transitivity (vsub (vscale (dot a x) a) (cross a (cross a x))); [clear; by_components|].
    rewrite X. clear. by_components. }
  assert (W : vscale (norm2 a * norm2 a) (cross u v) = vzero).
  { transitivity (cross (vscale (norm2 a) u) (vscale (norm2 a) v)); [clear; by_components|].
    rewrite !along by assumption. clear. by_components. }
  transitivity (vscale (/ (norm2 a * norm2 a)) (vscale (norm2 a * norm2 a) (cross u v))).
  - generalize dependent (norm2 a). intros n Hn _ _. destruct u, v. unfold_vectors.
    f_equal; field; assumption.
  - rewrite W. clear. by_components.
Qed.

Lemma flat l a b : mass l <> 0 ->
  (forall p, In p l -> weight p = 0 \/ cross a (vsub (source p) b) = vzero) ->
  quadratic (inertia l) a = 0.
Proof.
  intros M H. rewrite inertia_form_given. apply sum_of_zeros. intros p I.
  destruct (H p I) as [-> | E]; [ring|].
  replace (cross a (vsub (source p) (centre source l))) with vzero; [unfold norm2, dot; simpl; ring|].
  pose proof (centre_on_line l a b M H) as E'.
  transitivity (vsub (cross a (vsub (source p) b)) (cross a (vsub (centre source l) b))).
  - rewrite E, E'. clear. by_components.
  - generalize (centre source l). clear. by_components.
Qed.

(** A point of positive weight with a property, or no such point. *)
Lemma heavy_or_none (P : pair -> Prop) l : (forall p, {P p} + {~ P p}) ->
  (forall p, In p l -> 0 <= weight p) ->
  (exists p, In p l /\ 0 < weight p /\ P p) \/ forall p, In p l -> weight p = 0 \/ ~ P p.
Proof.
  intros D N.
  destruct (Exists_dec (fun p => 0 < weight p /\ P p) l) as [E | E].
  - intro p. destruct (Rlt_dec 0 (weight p)), (D p); tauto.
  - left. apply Exists_exists in E. destruct E as (p & I & W & H). eauto.
  - right. intros p I. specialize (N p I). destruct (D p) as [H | H]; [left | right; exact H].
    destruct (Rle_lt_or_eq_dec _ _ N) as [W | W]; [|auto].
    exfalso. apply E, Exists_exists. eauto.
Qed.

(** J is positive definite just where three points of positive weight are not on a line. *)
Theorem inertia_definite_iff l : (forall p, In p l -> 0 <= weight p) -> mass l <> 0 ->
  positive_definite (inertia l) <-> not_collinear l.
Proof.
  intros N M. split.
  - intro D.
    assert (spread : forall a b, a <> vzero ->
      exists r, In r l /\ 0 < weight r /\ cross a (vsub (source r) b) <> vzero).
    { intros a b A.
      destruct (heavy_or_none (fun r => cross a (vsub (source r) b) <> vzero) l) as [E | E]; auto.
      - intro r. destruct (vec_eq_dec (cross a (vsub (source r) b)) vzero); [right | left]; auto.
      - exfalso. specialize (D a A). rewrite (flat l a b M) in D; [lra|].
        intros p I. destruct (E p I) as [W | W]; [auto|].
        right. destruct (vec_eq_dec (cross a (vsub (source p) b)) vzero); tauto. }
    destruct (heavy_or_none (fun _ => True) l) as [(p & Ip & Wp & _) | E]; auto.
    + destruct (spread (Vec 1 0 0) (source p)) as (q & Iq & Wq & Q); [intro E; injection E; lra|].
      destruct (spread (vsub (source q) (source p)) (source p)) as (r & Ir & Wr & X).
      { intro E. apply Q. rewrite E. clear. by_components. }
      exists p, q, r. auto.
    + exfalso. apply M, sum_of_zeros. intros p I. destruct (E p I); tauto.
  - intros (p & q & r & (Ip & Wp) & (Iq & Wq) & (Ir & Wr) & X) a A.
    rewrite inertia_form_given. set (f := fun p : pair => _).
    assert (P : forall s, In s l -> 0 <= f s).
    { intros s I. apply Rmult_le_pos; [auto | apply norm2_nonnegative]. }
    destruct (Rle_lt_or_eq_dec _ _ (sum_nonnegative f l P)) as [L | L]; [exact L|].
    exfalso. apply X.
    assert (Z : forall s, In s l -> 0 < weight s ->
                  cross a (vsub (source s) (centre source l)) = vzero).
    { intros s I W. apply norm2_zero.
      pose proof (sum_zero f l P (eq_sym L) s I) as F. unfold f in F.
      apply Rmult_integral in F. destruct F as [F | F]; [lra | exact F]. }
    assert (across : forall s, In s l -> 0 < weight s ->
                       cross a (vsub (source s) (source p)) = vzero).
    { intros s I W.
      transitivity (vsub (cross a (vsub (source s) (centre source l)))
                         (cross a (vsub (source p) (centre source l)))).
      - generalize (centre source l). clear. by_components.
      - rewrite !Z by assumption. clear. by_components. }
    apply (parallel a); auto.
Qed.
