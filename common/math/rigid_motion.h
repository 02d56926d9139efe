#pragma once

#include <optional>

#include <glm/glm.hpp>

/// Rotations and rigid motions that are made over and over: a car that turns a little every frame must still
/// be a car after a million frames.
///
/// A body's frame is right-handed, x = y × z: y up, it faces +z, and so +x is to its left (seen from behind,
/// with y up and z away, x points left). Turning left is a positive turn about y: z goes towards +x. The
/// camera of math/transform.h looks along −z, so one that sees what the body faces is turned half round about
/// y: its right is −x of the body.
///
/// What exactness costs, in times of the textbook's form (bench_rigid_motion): turns two to four, since sine
/// and cosine are those of double; arcs three; frames and rigid inverses less than one.
///
/// u = 2^-53. Rounding a rotation to float alone makes |RᵀR − I| up to 2 √3 2^-25 = 1.03e-7, and moves an
/// entry by 2^-25 = 2.98e-8.
namespace quincunx {

// ---- one turn ----

/// The rotation by `radians` about an axis of any length, counter-clockwise seen with the axis pointing at
/// one: entries within 16 u of exact for every finite angle, tiny and huge, since sine and cosine of the half
/// angle carry all of it and 1 − cos is never formed. The identity for an axis that is zero or not finite
/// and for an angle that is not finite. Held by TurnMatrix.*.
glm::dmat3 turnMatrix(glm::dvec3 axis, double radians);
/// The same rounded once: entries within 2^-25 + 16 u.
glm::mat3 turnMatrix(glm::vec3 axis, float radians);

/// Rodrigues' formula as in books: c I + s [n] + (1 − c) n nᵀ, n = axis/|axis|, in float.
glm::mat3 turnMatrixNaive(glm::vec3 axis, float radians);

// ---- orthonormal again ----

/// A rotation from columns of any length that are not quite at right angles: z keeps its direction, y its
/// plane with z, x is y × z, whatever it was; so a mirrored frame comes out unmirrored. Gram–Schmidt's result
/// without its subtraction: x from the exact cross product, then y = z × x. Entries within 2^-25 + 16 u of
/// exact for every finite y and z that are not parallel, however near to it; none if they are (decided
/// exactly), or not finite. Held by GramSchmidt.*.
std::optional<glm::mat3> gramSchmidt(const glm::mat3& frame);

/// The textbook's: y − (y·z) z, in float.
glm::mat3 gramSchmidtNaive(const glm::mat3& frame);

/// As `gramSchmidt`, but the basis comes from z alone (Duff et al., "Building an orthonormal basis,
/// revisited", JCGT 6(1), 2017) and is then turned about z until its y is as near to the old one as it can
/// be. The same result within 2^-24 + 16 u |y|/|y × z|; none in the same cases. Held by GramSchmidt.*.
std::optional<glm::mat3> orthonormalizedByDuff(const glm::mat3& frame);

/// The rotation that is nearest to `m` (Frobenius): the orthogonal factor of the polar decomposition, by
/// Newton's iteration X ← (γ X + X⁻ᵀ/γ)/2 with Frobenius scaling (Higham, "Computing the polar decomposition
/// with applications", SIAM J. Sci. Stat. Comput. 7, 1986). Nothing is preferred: every column gives way.
/// Entries within 2^-25 + 64 u κ, κ = σ1/(σ2 + σ3) by the singular values, the condition of the problem;
/// orthonormal as any rounded rotation. None if det m ≤ 0 (decided exactly: a mirrored frame is near to no
/// one rotation), if m is not finite, or if κ exceeds 2^40. Held by NearestRotation.*.
std::optional<glm::mat3> nearestRotation(const glm::mat3& m);

/// One Newton–Schulz step X (3 I − XᵀX)/2 in double, rounded once: for |XᵀX − I| ≤ e in every entry leaves
/// 3 e² beside the rounding, so one step does for frames that drifted up to 1e-4. Held by NearestRotation.*.
glm::mat3 newtonSchulzStep(const glm::mat3& nearlyRotation);

// ---- many turns ----

/// What the flashcard does to turn left, word for word: z += ε x, z /= |z|, x = z × y. Since z × y = −x the
/// frame is mirrored after one turn, and goes the other way from then on.
glm::mat3 turnLeftMirroredNaive(const glm::mat3& worldFromBody, float epsilon);
/// The same with x = y × z. It turns by atan ε, not ε, and the rounding of each step stays.
glm::mat3 turnLeftNaive(const glm::mat3& worldFromBody, float epsilon);
/// R times the turn's matrix, in float: the rounding of each step stays.
glm::mat3 turnedNaive(const glm::mat3& worldFromBody, glm::vec3 axisBody, float radians);

/// A frame of floats, turned about an axis of its own: multiplied in double, made orthonormal by
/// Newton–Schulz, rounded once. |RᵀR − I| ≤ 1.1e-7 and det = +1 after any number of turns; the direction
/// strays by the rounding alone, 2^-25 an entry and turn, like a random walk. (`Orientation` does not.)
/// None if the frame is nearest to no rotation or something is not finite. Held by Turned.*.
std::optional<glm::mat3> turned(const glm::mat3& worldFromBody, glm::vec3 axisBody, float radians);

/// How a body is turned, as a unit quaternion in double: the state to keep where turns add up. After n turns
/// each entry of `worldFromBody` is within 16 n u of the exact product (1.8e-9 after a million), and
/// |RᵀR − I| ≤ 32 u however large n is: each turn takes the length's error out to first order,
/// q (3 − |q|²)/2. Plain data: copies are the same bits. Held by Orientation.*.
class Orientation {
  public:
    /// The axes of the world.
    Orientation() = default;

    /// Turns about an axis of the body (of the world), of any length, by any finite angle, as `turnMatrix`
    /// does; what that takes for the identity is no turn.
    void turnAboutBody(glm::dvec3 axisBody, double radians);
    void turnAboutWorld(glm::dvec3 axisWorld, double radians);

    glm::dmat3 worldFromBody() const;
    /// Rounded once: |RᵀR − I| ≤ 1.1e-7.
    glm::mat3 worldFromBodyFloat() const { return glm::mat3(worldFromBody()); }

    bool operator==(const Orientation&) const = default;

  private:
    double w_ = 1;
    double x_ = 0;
    double y_ = 0;
    double z_ = 0;
};

/// A sum of angles that does not forget small ones when it is large: sum and rounding error apart (Knuth's
/// two-sum), so that after n terms it is within n 2^-106 Σ|terms|. Held by AngleSum.*.
class AngleSum {
  public:
    AngleSum() = default;
    explicit AngleSum(double radians) : high_(radians) {}

    /// A term that is not finite is left out.
    void add(double radians);
    double radians() const { return high_ + low_; }
    /// (cos, sin) of the sum, each within 4 u, for sums up to 2^40.
    glm::dvec2 direction() const;

    bool operator==(const AngleSum&) const = default;

  private:
    double high_ = 0;
    double low_ = 0;
};

/// (cos, sin) of a sum of floats kept in a float.
glm::vec2 angleSumDirectionNaive(float radians);

/// Where one comes who goes `distance` along a circle that bends to the left by `curvature` (one over its
/// radius; negative to the right; zero: straight on): forwards and to the left of where one faced at first.
/// sin(φ)/φ · distance at the angle φ = curvature · distance / 2, with the rounding of φ carried along, so
/// that nothing cancels where the circle is large. Within 16 u of the distance or the circle's diameter,
/// whichever is less, for |φ| up to 2^40. Zero if something is not finite. Held by ArcOffset.*.
glm::dvec2 arcOffset(double distance, double curvature);

/// (sin(κ s)/κ, (1 − cos(κ s))/κ), in float.
glm::vec2 arcOffsetNaive(float distance, float curvature);

// ---- places ----

/// Where a body is and how it is turned, in double: world_from_body = T R. Large worlds need it, since a
/// float at 10⁶ m knows no less than 6 cm.
struct RigidPose {
    glm::dmat3 rotation{1};  ///< orthonormal to a few u
    glm::dvec3 origin{0};

    /// (T R)⁻¹ = Rᵀ T⁻¹.
    RigidPose inverse() const;
    glm::mat4 matrix() const;  ///< rounded once
};
RigidPose operator*(const RigidPose& aFromB, const RigidPose& bFromC);

/// The camera at `eyeBody` (the body's frame) that sees what the body faces: half a turn about y.
RigidPose cameraFacing(const RigidPose& worldFromBody, glm::dvec3 eyeBody);

/// The matrix from a model to the camera, through the difference of their origins in double: each entry
/// within 2^-25 of itself plus 8 u of the largest of its row (of the distance between the two, in the last
/// column). How far both are from the world's origin does not enter: a difference of doubles is rounded by u
/// of itself, and is exact where the two are near. Held by CameraFromModel.*.
glm::mat4 cameraFromModel(const RigidPose& worldFromCamera, const RigidPose& worldFromModel);

/// The general inverse times the model's matrix, all in float.
glm::mat4 cameraFromModelNaive(const glm::mat4& worldFromCamera, const glm::mat4& worldFromModel);

/// −Rᵀ t in float: what `cameraFromWorld` (math/transform.h) is in a textbook.
glm::mat4 cameraFromWorldNaive(const glm::mat4& worldFromCamera);

}  // namespace quincunx
