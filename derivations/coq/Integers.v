(** Clouds of dyadic rationals, and their moments in integers.

    Claimed: the integer matrices computed here are, up to a positive factor, the cross-covariance and
    the inertia of the real clouds, centring included; integer tests of positive definiteness and of
    the pattern decide the real ones. Nothing is rounded. *)

Require Import Reals Lra ZArith List Bool Lia.
From Coquelicot Require Import Rcomplements.
From Certreg Require Import Vectors Quaternions Davenport Spectral Clouds Moments Equilibria
  SingularValues Certificate Definite.
Import ListNotations.
Open Scope R_scope.

(** ** Dyadic numbers *)

Record dyadic := Dyadic { mantissa : Z; exponent : Z }.

Definition two (e : Z) := powerRZ 2 e.
Definition value (x : dyadic) := IZR (mantissa x) * two (exponent x).

(** x / 2^b, an integer for b <= exponent x. *)
Definition align (b : Z) (x : dyadic) := Z.shiftl (mantissa x) (exponent x - b).
Definition at_most (x y : dyadic) :=
  let b := Z.min (exponent x) (exponent y) in Z.leb (align b x) (align b y).
Definition times (x y : dyadic) :=
  Dyadic (mantissa x * mantissa y) (exponent x + exponent y).
Definition twice (x : dyadic) := Dyadic (mantissa x) (exponent x + 1).

Lemma two_positive e : 0 < two e.
Proof. apply powerRZ_lt. lra. Qed.

Lemma two_add a b : two (a + b) = two a * two b.
Proof. apply powerRZ_add. lra. Qed.

Lemma two_nonnegative n : (0 <= n)%Z -> two n = IZR (2 ^ n).
Proof.
  intro H. unfold two. rewrite <- (Z2Nat.id n H). rewrite <- pow_powerRZ, <- pow_IZR. reflexivity.
Qed.

Lemma align_value b x : (b <= exponent x)%Z -> IZR (align b x) * two b = value x.
Proof.
  intro H. unfold align, value. rewrite Z.shiftl_mul_pow2 by lia.
  rewrite mult_IZR, <- two_nonnegative by lia.
  replace (exponent x) with (exponent x - b + b)%Z at 2 by lia. rewrite two_add. ring.
Qed.

Lemma at_most_value x y : at_most x y = true <-> value x <= value y.
Proof.
  unfold at_most. rewrite Z.leb_le.
  set (b := Z.min (exponent x) (exponent y)).
  rewrite <- (align_value b x), <- (align_value b y) by (unfold b; lia).
  pose proof (two_positive b) as P. split; intro H.
  - apply IZR_le in H. nra.
  - apply le_IZR. apply (Rmult_le_reg_r (two b)); assumption.
Qed.

Lemma times_value x y : value (times x y) = value x * value y.
Proof. unfold value, times; cbn [mantissa exponent]. rewrite mult_IZR, two_add. ring. Qed.

Lemma twice_value x : value (twice x) = 2 * value x.
Proof.
  unfold value, twice; cbn [mantissa exponent]. rewrite two_add.
  replace (two 1) with 2 by (unfold two; simpl; ring). ring.
Qed.

(** ** Clouds *)

(** Integers that stand for w 2^ew, x 2^ex, y 2^ey. *)
Record zpair := ZPair { zw : Z; zx1 : Z; zx2 : Z; zx3 : Z; zy1 : Z; zy2 : Z; zy3 : Z }.
Record data := Data { points : list zpair; ew : Z; ex : Z; ey : Z }.

Definition real_pair d p :=
  Pair (IZR (zw p) * two (ew d))
       (Vec (IZR (zx1 p) * two (ex d)) (IZR (zx2 p) * two (ex d)) (IZR (zx3 p) * two (ex d)))
       (Vec (IZR (zy1 p) * two (ey d)) (IZR (zy2 p) * two (ey d)) (IZR (zy3 p) * two (ey d))).
Definition real_cloud d : cloud := map (real_pair d) (points d).

Fixpoint zsum (f : zpair -> Z) (l : list zpair) : Z :=
  match l with nil => 0 | p :: rest => f p + zsum f rest end%Z.

Record zmat := ZMat { z11 : Z; z12 : Z; z13 : Z; z21 : Z; z22 : Z; z23 : Z;
                      z31 : Z; z32 : Z; z33 : Z }.
Record zsym := ZSym { t00 : Z; t01 : Z; t02 : Z; t03 : Z; t11 : Z; t12 : Z; t13 : Z;
                      t22 : Z; t23 : Z; t33 : Z }.
Record zquat := ZQuat { aw : Z; ax : Z; ay : Z; az : Z }.
Record zvec := ZVec { b1 : Z; b2 : Z; b3 : Z }.

Definition real_mat A :=
  Mat (IZR (z11 A)) (IZR (z12 A)) (IZR (z13 A)) (IZR (z21 A)) (IZR (z22 A)) (IZR (z23 A))
      (IZR (z31 A)) (IZR (z32 A)) (IZR (z33 A)).
Definition real_sym A :=
  Sym (IZR (t00 A)) (IZR (t01 A)) (IZR (t02 A)) (IZR (t03 A)) (IZR (t11 A)) (IZR (t12 A))
      (IZR (t13 A)) (IZR (t22 A)) (IZR (t23 A)) (IZR (t33 A)).
Definition real_quat q := Quat (IZR (aw q)) (IZR (ax q)) (IZR (ay q)) (IZR (az q)).
Definition real_vec a := Vec (IZR (b1 a)) (IZR (b2 a)) (IZR (b3 a)).

Definition zmass d := zsum zw (points d).

(** M sum w f g - (sum w f) (sum w g), for coordinates f and g. *)
Definition zcentred d f g :=
  let l := points d in
  (zmass d * zsum (fun p => zw p * f p * g p) l
   - zsum (fun p => zw p * f p) l * zsum (fun p => zw p * g p) l)%Z.

Definition zcovariance d :=
  ZMat (zcentred d zy1 zx1) (zcentred d zy1 zx2) (zcentred d zy1 zx3)
       (zcentred d zy2 zx1) (zcentred d zy2 zx2) (zcentred d zy2 zx3)
       (zcentred d zy3 zx1) (zcentred d zy3 zx2) (zcentred d zy3 zx3).
Definition zinertia d :=
  let s11 := zcentred d zx1 zx1 in let s22 := zcentred d zx2 zx2 in
  let s33 := zcentred d zx3 zx3 in let s12 := (- zcentred d zx1 zx2)%Z in
  let s13 := (- zcentred d zx1 zx3)%Z in let s23 := (- zcentred d zx2 zx3)%Z in
  ZMat (s22 + s33) s12 s13 s12 (s11 + s33) s23 s13 s23 (s11 + s22).

(** Second moments about any points a and b, from those about 0. *)
Lemma shifted_covariance l a b :
  msum (fun p => mscale (weight p) (outer (vsub (target p) b) (vsub (source p) a))) l =
  msub (madd (moment_yx l) (mscale (moment0 l) (outer b a)))
       (madd (outer b (moment_x l)) (outer (moment_y l) a)).
Proof. by_induction l. Qed.

Lemma shifted_scatter l a :
  msum (fun p => mscale (weight p) (outer (vsub (source p) a) (vsub (source p) a))) l =
  msub (madd (moment_xx l) (mscale (moment0 l) (outer a a)))
       (madd (outer a (moment_x l)) (outer (moment_x l) a)).
Proof. by_induction l. Qed.

Lemma msum_map f h l : msum f (map h l) = msum (fun p => f (h p)) l.
Proof. induction l; simpl; congruence. Qed.

Lemma covariance_uncentred l : mass l <> 0 ->
  cross_covariance l =
  mscale (/ mass l) (msub (mscale (mass l) (moment_yx l)) (outer (moment_y l) (moment_x l))).
Proof.
  intro H. unfold cross_covariance, centred. rewrite msum_map. cbn [weight source target].
  rewrite shifted_covariance. unfold centre. fold (moment_x l) (moment_y l).
  change (moment0 l) with (mass l).
  generalize dependent (mass l). generalize (moment_x l) (moment_y l) (moment_yx l). clear.
  intros. open_vectors. unfold_vectors. f_equal; field; assumption.
Qed.

Lemma scatter_uncentred l : mass l <> 0 ->
  scatter l =
  mscale (/ mass l) (msub (mscale (mass l) (moment_xx l)) (outer (moment_x l) (moment_x l))).
Proof.
  intro H. unfold scatter, centred. rewrite msum_map. cbn [weight source target].
  rewrite shifted_scatter. unfold centre. fold (moment_x l).
  change (moment0 l) with (mass l).
  generalize dependent (mass l). generalize (moment_x l) (moment_xx l). clear.
  intros. open_vectors. unfold_vectors. f_equal; field; assumption.
Qed.


Lemma mass_real d : mass (real_cloud d) = IZR (zmass d) * two (ew d).
Proof.
  unfold mass, zmass, real_cloud. induction (points d) as [|p l IH];
    cbn [map Clouds.sum zsum]; [ring|]. rewrite IH, plus_IZR. unfold real_pair. cbn [weight]. ring.
Qed.

Definition zfirst f d := zsum (fun p => zw p * f p)%Z (points d).
Definition zsecond f g d := zsum (fun p => zw p * f p * g p)%Z (points d).

Ltac by_points d :=
  unfold moment_x, moment_y, moment_yx, moment_xx, zfirst, zsecond, real_cloud;
  induction (points d) as [|p l IH]; cbn [map vsum msum zsum];
  [ unfold_vectors; try f_equal; ring
  | rewrite IH; clear IH; unfold real_pair; cbn [weight source target];
    rewrite !plus_IZR, !mult_IZR; unfold_vectors; f_equal; ring ].

Lemma moment_x_real d : moment_x (real_cloud d) =
  vscale (two (ew d) * two (ex d))
         (Vec (IZR (zfirst zx1 d)) (IZR (zfirst zx2 d)) (IZR (zfirst zx3 d))).
Proof. by_points d. Qed.

Lemma moment_y_real d : moment_y (real_cloud d) =
  vscale (two (ew d) * two (ey d))
         (Vec (IZR (zfirst zy1 d)) (IZR (zfirst zy2 d)) (IZR (zfirst zy3 d))).
Proof. by_points d. Qed.

Lemma moment_yx_real d : moment_yx (real_cloud d) =
  mscale (two (ew d) * two (ex d) * two (ey d))
    (Mat (IZR (zsecond zy1 zx1 d)) (IZR (zsecond zy1 zx2 d)) (IZR (zsecond zy1 zx3 d))
         (IZR (zsecond zy2 zx1 d)) (IZR (zsecond zy2 zx2 d)) (IZR (zsecond zy2 zx3 d))
         (IZR (zsecond zy3 zx1 d)) (IZR (zsecond zy3 zx2 d)) (IZR (zsecond zy3 zx3 d))).
Proof. by_points d. Qed.

Lemma moment_xx_real d : moment_xx (real_cloud d) =
  mscale (two (ew d) * two (ex d) * two (ex d))
    (Mat (IZR (zsecond zx1 zx1 d)) (IZR (zsecond zx1 zx2 d)) (IZR (zsecond zx1 zx3 d))
         (IZR (zsecond zx1 zx2 d)) (IZR (zsecond zx2 zx2 d)) (IZR (zsecond zx2 zx3 d))
         (IZR (zsecond zx1 zx3 d)) (IZR (zsecond zx2 zx3 d)) (IZR (zsecond zx3 zx3 d))).
Proof. by_points d. Qed.

Lemma zcentred_real d f g :
  IZR (zcentred d f g) =
  IZR (zmass d) * IZR (zsecond f g d) - IZR (zfirst f d) * IZR (zfirst g d).
Proof. unfold zcentred, zsecond, zfirst. rewrite minus_IZR, !mult_IZR. reflexivity. Qed.

(** What the integers stand for: C and J over unit / M. *)
Definition covariance_unit d := two (ew d + ex d + ey d) / IZR (zmass d).
Definition inertia_unit d := two (ew d + ex d + ex d) / IZR (zmass d).

(** The integer matrix is the cross-covariance of the real clouds, centred, over a known unit. *)
Theorem covariance_real d : IZR (zmass d) <> 0 ->
  cross_covariance (real_cloud d) = mscale (covariance_unit d) (real_mat (zcovariance d)).
Proof.
  intro H. pose proof (two_positive (ew d)) as P.
  rewrite covariance_uncentred by (rewrite mass_real; apply Rmult_integral_contrapositive; lra).
  rewrite mass_real, moment_x_real, moment_y_real, moment_yx_real.
  unfold covariance_unit, zcovariance, real_mat. rewrite !two_add.
  cbn [z11 z12 z13 z21 z22 z23 z31 z32 z33]. rewrite !zcentred_real.
  generalize dependent (IZR (zmass d)). intros. unfold_vectors. f_equal; field; lra.
Qed.

(** The same for the inertia. *)
Theorem inertia_real d : IZR (zmass d) <> 0 ->
  inertia (real_cloud d) = mscale (inertia_unit d) (real_mat (zinertia d)).
Proof.
  intro H. pose proof (two_positive (ew d)) as P.
  rewrite inertia_is_trace_minus_scatter.
  rewrite scatter_uncentred by (rewrite mass_real; apply Rmult_integral_contrapositive; lra).
  rewrite mass_real, moment_x_real, moment_xx_real.
  unfold inertia_unit, zinertia, real_mat. rewrite !two_add.
  cbn [z11 z12 z13 z21 z22 z23 z31 z32 z33].
  rewrite ?plus_IZR, ?opp_IZR, !zcentred_real.
  generalize dependent (IZR (zmass d)). intros. unfold_vectors. f_equal; field; lra.
Qed.

(** ** Tests *)

Definition zpositive2 a b c := (0 <? a)%Z && (0 <? a * c - b * b)%Z.
Definition zpositive3 a b c d e f :=
  (0 <? a)%Z && zpositive2 (a * d - b * b) (a * e - b * c) (a * f - c * c).
Definition zpositive4 A :=
  let '(ZSym a b c d e f g h i j) := A in
  (0 <? a)%Z && zpositive3 (a * e - b * b) (a * f - b * c) (a * g - b * d) (a * h - c * c)
                           (a * i - c * d) (a * j - d * d).

Lemma positive_real a : (0 <? a)%Z = true <-> 0 < IZR a.
Proof. rewrite Z.ltb_lt. split; [apply IZR_lt | apply lt_IZR]. Qed.

Lemma zpositive2_real a b c : zpositive2 a b c = true <-> positive2 (IZR a) (IZR b) (IZR c).
Proof.
  unfold zpositive2, positive2. rewrite andb_true_iff, !positive_real, minus_IZR, !mult_IZR.
  reflexivity.
Qed.

Lemma zpositive3_real a b c d e f : zpositive3 a b c d e f = true <->
  positive3 (IZR a) (IZR b) (IZR c) (IZR d) (IZR e) (IZR f).
Proof.
  unfold zpositive3, positive3.
  rewrite andb_true_iff, positive_real, zpositive2_real, !minus_IZR, !mult_IZR. reflexivity.
Qed.

(** The integer test of a 4x4 matrix decides positive definiteness over the real numbers. *)
Theorem zpositive4_real A : zpositive4 A = true <-> form_positive (real_sym A).
Proof.
  rewrite <- positive4_iff. destruct A as [a b c d e f g h i j]. unfold zpositive4, positive4, real_sym.
  cbn [t00 t01 t02 t03 t11 t12 t13 t22 t23 t33].
  rewrite andb_true_iff, positive_real, zpositive3_real, !minus_IZR, !mult_IZR. reflexivity.
Qed.

(** Whether J is positive definite: three noncollinear points of positive weight. *)
Definition solid d :=
  let J := zinertia d in zpositive3 (z11 J) (z12 J) (z13 J) (z22 J) (z23 J) (z33 J).

Lemma quadratic_scale k A a : quadratic (mscale k A) a = k * quadratic A a.
Proof. by_components. Qed.

(** The integer test of the inertia decides whether J is positive definite. *)
Theorem solid_real d : 0 < IZR (zmass d) ->
  solid d = true <-> positive_definite (inertia (real_cloud d)).
Proof.
  intro H. rewrite inertia_real by lra.
  assert (U : 0 < inertia_unit d) by (apply Rdiv_lt_0_compat; [apply two_positive | assumption]).
  unfold solid. rewrite zpositive3_real.
  rewrite (positive3_definite (real_mat (zinertia d))) by reflexivity.
  unfold positive_definite. split; intros P a N; specialize (P a N); rewrite quadratic_scale in *; nra.
Qed.

Definition zdavenport C :=
  ZSym (z11 C + z22 C + z33 C) (z32 C - z23 C) (z13 C - z31 C) (z21 C - z12 C)
       (z11 C - z22 C - z33 C) (z12 C + z21 C) (z13 C + z31 C)
       (z22 C - z11 C - z33 C) (z23 C + z32 C) (z33 C - z11 C - z22 C).

Lemma zdavenport_real C : real_sym (zdavenport C) = davenport (real_mat C).
Proof.
  unfold real_sym, zdavenport, davenport, real_mat.
  cbn [t00 t01 t02 t03 t11 t12 t13 t22 t23 t33 m11 m12 m13 m21 m22 m23 m31 m32 m33].
  rewrite !minus_IZR, !plus_IZR. reflexivity.
Qed.

Definition zform A q :=
  (t00 A * (aw q * aw q) + t11 A * (ax q * ax q) + t22 A * (ay q * ay q) + t33 A * (az q * az q)
   + 2 * (t01 A * (aw q * ax q) + t02 A * (aw q * ay q) + t03 A * (aw q * az q)
          + t12 A * (ax q * ay q) + t13 A * (ax q * az q) + t23 A * (ay q * az q)))%Z.
Definition znorm2 q := (aw q * aw q + ax q * ax q + ay q * ay q + az q * az q)%Z.

Lemma zform_real A q : IZR (zform A q) = form (real_sym A) (real_quat q).
Proof.
  unfold zform. repeat rewrite ?plus_IZR, ?mult_IZR.
  destruct A, q. unfold real_sym, real_quat. unfold_forms.
  cbn [t00 t01 t02 t03 t11 t12 t13 t22 t23 t33 aw ax ay az]. ring.
Qed.

Lemma znorm2_real q : IZR (znorm2 q) = qnorm2 (real_quat q).
Proof.
  unfold znorm2. repeat rewrite ?plus_IZR, ?mult_IZR. destruct q. reflexivity.
Qed.

(** ** The pattern *)

Definition zdiscriminant (e f g : Z) :=
  (e * e * (f * f) - 4 * (f * f * f) - 4 * (e * e * e) * g + 18 * (e * f * g) - 27 * (g * g))%Z.
Definition zside (e f g : Z) := (2 * (e * e * e) - 9 * (e * f) + 27 * g)%Z.

Definition zdecide (e f D : Z) : list nat :=
  if (zdiscriminant e f (D * D) =? 0)%Z then
    if (f =? 0)%Z then (if (e =? 0)%Z then [4] else [2; 2])%nat
    else if (zside e f (D * D) =? 0)%Z then (if (0 <? D)%Z then [1; 3] else [3; 1])%nat
    else if (zside e f (D * D) <? 0)%Z then [1; 2; 1]%nat
    else (if (0 <? D)%Z then [1; 1; 2] else [2; 1; 1])%nat
  else [1; 1; 1; 1]%nat.

Lemma if_zero {X : Type} a (x y : X) :
  (if (a =? 0)%Z then x else y) = if Req_EM_T (IZR a) 0 then x else y.
Proof.
  destruct (Z.eqb_spec a 0) as [N | N]; destruct (Req_EM_T (IZR a) 0) as [E | E];
    try reflexivity; exfalso.
  - apply E. rewrite N. reflexivity.
  - apply N, eq_IZR, E.
Qed.

Lemma if_less {X : Type} a b (x y : X) :
  (if (a <? b)%Z then x else y) = if Rlt_dec (IZR a) (IZR b) then x else y.
Proof.
  destruct (Z.ltb_spec a b) as [N | N], (Rlt_dec (IZR a) (IZR b)) as [E | E]; try reflexivity.
  - exfalso. apply E, IZR_lt, N.
  - exfalso. apply lt_IZR in E. lia.
Qed.

Lemma zdecide_real e f D : zdecide e f D = decide (IZR e) (IZR f) (IZR D).
Proof.
  unfold zdecide, decide. rewrite !if_zero, !if_less.
  replace (IZR (zdiscriminant e f (D * D))) with (discriminant (IZR e) (IZR f) (IZR D * IZR D))
    by (unfold zdiscriminant, discriminant;
        repeat rewrite ?minus_IZR, ?plus_IZR, ?mult_IZR; reflexivity).
  replace (IZR (zside e f (D * D))) with (side (IZR e) (IZR f) (IZR D * IZR D))
    by (unfold zside, side; repeat rewrite ?minus_IZR, ?plus_IZR, ?mult_IZR; reflexivity).
  reflexivity.
Qed.

Definition zgram C :=
  let g a b c a' b' c' := (a * a' + b * b' + c * c')%Z in
  ZSym 0 0 0 0 (g (z11 C) (z21 C) (z31 C) (z11 C) (z21 C) (z31 C))
       (g (z11 C) (z21 C) (z31 C) (z12 C) (z22 C) (z32 C))
       (g (z11 C) (z21 C) (z31 C) (z13 C) (z23 C) (z33 C))
       (g (z12 C) (z22 C) (z32 C) (z12 C) (z22 C) (z32 C))
       (g (z12 C) (z22 C) (z32 C) (z13 C) (z23 C) (z33 C))
       (g (z13 C) (z23 C) (z33 C) (z13 C) (z23 C) (z33 C)).
Definition zdet C :=
  (z11 C * (z22 C * z33 C - z23 C * z32 C) - z12 C * (z21 C * z33 C - z23 C * z31 C)
   + z13 C * (z21 C * z32 C - z22 C * z31 C))%Z.

Definition zpattern C :=
  let P := zgram C in
  zdecide (t11 P + t22 P + t33 P)
          (t11 P * t22 P - t12 P * t12 P + (t11 P * t33 P - t13 P * t13 P)
           + (t22 P * t33 P - t23 P * t23 P)) (zdet C).

Lemma spectral_scaled A k u c : 0 < c -> spectral A k u ->
  spectral (sscale c A) (fun i => c * k i) u.
Proof.
  intros Hc [O E D]. split.
  - exact O.
  - intro i. specialize (E i). unfold eigen in *.
    transitivity (qscale c (apply A (u i))); [clear; by_forms|]. rewrite E. clear. by_entries.
  - destruct D as (D1 & D2 & D3). repeat split; apply Rmult_le_compat_l; lra.
Qed.

Lemma pattern_scaled k c : 0 < c -> pattern (fun i => c * k i) = pattern k.
Proof.
  intro Hc. assert (E : forall x y, c * x = c * y -> x = y)
    by (intros x y H; apply (Rmult_eq_reg_l c); lra).
  unfold pattern.
  destruct (Req_EM_T (c * k I1) (c * k I2)), (Req_EM_T (k I1) (k I2)); try (exfalso; auto; congruence);
  destruct (Req_EM_T (c * k I2) (c * k I3)), (Req_EM_T (k I2) (k I3)); try (exfalso; auto; congruence);
  destruct (Req_EM_T (c * k I3) (c * k I4)), (Req_EM_T (k I3) (k I4)); try (exfalso; auto; congruence);
  reflexivity.
Qed.

(** The integers decide the multiplicities of the real eigenvalues, which are irrational as a rule. *)
Theorem zpattern_real C c k u : 0 < c ->
  spectral (davenport (mscale c (real_mat C))) k u -> pattern k = zpattern C.
Proof.
  intros Hc S.
  assert (Ci : 0 < / c) by (apply Rinv_0_lt_compat; assumption).
  pose proof (spectral_scaled _ k u (/ c) Ci S) as S'.
  replace (sscale (/ c) (davenport (mscale c (real_mat C)))) with (davenport (real_mat C)) in S'.
  - rewrite <- (pattern_scaled k (/ c) Ci), (pattern_decided _ _ u S').
    unfold zpattern. rewrite zdecide_real. f_equal.
    + unfold sigma1, gram, zgram, real_mat. cbn [t11 t22 t33].
      repeat rewrite ?plus_IZR, ?mult_IZR. unfold_vectors. ring.
    + unfold sigma2, gram, zgram, real_mat. cbn [t11 t12 t13 t22 t23 t33].
      repeat rewrite ?plus_IZR, ?minus_IZR, ?mult_IZR. unfold_vectors. field.
    + unfold zdet, real_mat. repeat rewrite ?plus_IZR, ?minus_IZR, ?mult_IZR. unfold_vectors. ring.
  - generalize (real_mat C). clear - Hc. intros []. unfold_forms. f_equal; field; lra.
Qed.
