#include "labs/26_ray_tracing/mailbox_grid.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace quincunx {

MailboxGrid::MailboxGrid(TriangleView triangles, float density) : triangles_(triangles) {
    Bounds bounds;
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        const Triangle triangle = triangles[i];
        for (const glm::vec3& corner : {triangle.a, triangle.b, triangle.c})
            bounds.extend(corner);
    }
    if (bounds.empty())
        bounds = {glm::vec3(0), glm::vec3(1)};
    const glm::dvec3 extent = glm::dvec3(bounds.max) - glm::dvec3(bounds.min);
    // Cells reach a little over what they hold, so that a walk that is off by rounding misses nothing.
    const glm::dvec3 margin(1e-6 * std::max({extent.x, extent.y, extent.z, 1e-30}));
    min_ = glm::dvec3(bounds.min) - margin;
    max_ = glm::dvec3(bounds.max) + margin;
    const glm::dvec3 wide = max_ - min_;
    const double side =
        std::cbrt(wide.x * wide.y * wide.z / (density * static_cast<double>(triangles.size() + 1)));
    size_ = glm::clamp(glm::ivec3(glm::min(wide / side, glm::dvec3(128))), 1, 128);
    cellSize_ = wide / glm::dvec3(size_);

    first_.assign(indexOf(size_ - 1) + 2, 0);
    const auto forCells = [&](std::size_t index, const auto& visit) {
        const Triangle triangle = triangles[index];
        const glm::dvec3 low(glm::min(triangle.a, glm::min(triangle.b, triangle.c)));
        const glm::dvec3 high(glm::max(triangle.a, glm::max(triangle.b, triangle.c)));
        const auto cellAt = [&](glm::dvec3 p) {
            return glm::clamp(glm::ivec3(glm::floor((p - min_) / cellSize_)), glm::ivec3(0), size_ - 1);
        };
        const glm::ivec3 from = cellAt(low - 0.5 * margin);
        const glm::ivec3 to = cellAt(high + 0.5 * margin);
        for (int z = from.z; z <= to.z; ++z)
            for (int y = from.y; y <= to.y; ++y)
                for (int x = from.x; x <= to.x; ++x)
                    visit(indexOf({x, y, z}));
    };
    for (std::size_t i = 0; i < triangles.size(); ++i)
        forCells(i, [&](std::size_t cell) { ++first_[cell + 1]; });
    for (std::size_t cell = 1; cell < first_.size(); ++cell)
        first_[cell] += first_[cell - 1];
    contents_.resize(first_.back());
    std::vector<std::uint32_t> filled(first_.begin(), first_.end() - 1);
    for (std::size_t i = 0; i < triangles.size(); ++i)
        forCells(i, [&](std::size_t cell) { contents_[filled[cell]++] = static_cast<std::uint32_t>(i); });
}

double MailboxGrid::copies() const {
    return static_cast<double>(contents_.size()) / static_cast<double>(triangles_.size());
}

MailboxGrid::Walk::Walk(const MailboxGrid& grid, const Ray& ray, Mailboxes* mailboxes)
    : grid_(grid), ray_(ray), sheared_(ray), mailboxes_(mailboxes) {
    counts_.rays = 1;
    if (mailboxes_ != nullptr) {
        // Numbers that have been given to all boxes are not given again.
        if (++mailboxes_->ray == 0) {
            std::fill(mailboxes_->lastRay.begin(), mailboxes_->lastRay.end(), 0u);
            mailboxes_->ray = 1;
        }
        number_ = mailboxes_->ray;
    }
    const glm::dvec3 origin(ray.origin);
    const glm::dvec3 direction(ray.direction);
    double enter = 0;
    double leave = std::numeric_limits<double>::infinity();
    for (int axis = 0; axis < 3; ++axis) {
        if (direction[axis] == 0) {
            if (!(origin[axis] >= grid.min_[axis] && origin[axis] <= grid.max_[axis]))
                return;
            continue;
        }
        const double a = (grid.min_[axis] - origin[axis]) / direction[axis];
        const double b = (grid.max_[axis] - origin[axis]) / direction[axis];
        enter = std::max(enter, std::min(a, b));
        leave = std::min(leave, std::max(a, b));
    }
    if (!(enter <= leave))
        return;
    inside_ = true;
    const glm::dvec3 start = origin + enter * direction;
    for (int axis = 0; axis < 3; ++axis) {
        cell_[axis] =
            std::clamp(static_cast<int>(std::floor((start[axis] - grid.min_[axis]) / grid.cellSize_[axis])),
                       0, grid.size_[axis] - 1);
        way_[axis] = direction[axis] > 0 ? 1 : direction[axis] < 0 ? -1 : 0;
        if (way_[axis] == 0) {
            next_[axis] = std::numeric_limits<double>::infinity();
            continue;
        }
        const double border =
            grid.min_[axis] + (cell_[axis] + (way_[axis] > 0 ? 1 : 0)) * grid.cellSize_[axis];
        next_[axis] = (border - origin[axis]) / direction[axis];
        step_[axis] = grid.cellSize_[axis] / std::abs(direction[axis]);
    }
}

bool MailboxGrid::Walk::step() {
    if (!inside_)
        return false;
    ++counts_.nodes;
    const std::size_t cell = grid_.indexOf(cell_);
    for (std::uint32_t i = grid_.first_[cell]; i < grid_.first_[cell + 1]; ++i) {
        const std::uint32_t triangle = grid_.contents_[i];
        if (mailboxes_ != nullptr) {
            // What was found then is in `hit_` if it was the nearest, so that it need not be kept here.
            if (mailboxes_->lastRay[triangle] == number_)
                continue;
            mailboxes_->lastRay[triangle] = number_;
        }
        ++counts_.triangles;
        if (const auto found = sheared_.intersect(grid_.triangles_[triangle]);
            found && (!hit_ || found->t < hit_->t || (found->t == hit_->t && triangle < hit_->triangle)))
            hit_ = AcceleratorHit{found->t, found->weights, triangle, found->front};
    }
    const int axis = next_.x <= next_.y && next_.x <= next_.z ? 0 : next_.y <= next_.z ? 1 : 2;
    // A hit beyond this cell may have a nearer one before it in the next.
    if (hit_ && hit_->t < next_[axis] * (1 - 1e-9))
        return inside_ = false;
    cell_[axis] += way_[axis];
    next_[axis] += step_[axis];
    inside_ = cell_[axis] >= 0 && cell_[axis] < grid_.size_[axis] && way_[axis] != 0;
    return inside_;
}

std::optional<AcceleratorHit> MailboxGrid::nearest(const Ray& ray, Mailboxes* mailboxes,
                                                   TraversalCounts& counts) const {
    Walk walk(*this, ray, mailboxes);
    while (walk.step()) {
    }
    counts += walk.counts();
    return walk.hit();
}

}  // namespace quincunx
