// SPDX-License-Identifier: GPL-2.0-or-later
#include "CableElement.hpp"

#include "CableEngine.hpp"

#include <core/Aabb.hpp>
#include <core/Scene.hpp>

#include <cmath>
#include <mutex>

namespace yade {

YADE_PLUGIN((CableElement)(Bo1_CableElement_Aabb))

const CableView* CableElement::newView(const Scene& scene) const {
    static std::mutex building; // functors run side by side
    const std::lock_guard<std::mutex> lock(building);
    const CableView* known = seen.load();
    if (known && known->use()) return known;
    const auto next = CableEngine::viewOf(scene, family);
    seen.store(next.get());
    kept = next; // the engine keeps the one before for those who read it still
    return next.get();
}

const CableView* CableElement::view(const Scene& scene) const {
    const CableView* known = seen.load();
    if (!known || !known->use()) known = newView(scene);
    return known && element >= 0 && element < known->model->n_elements ? known : nullptr;
}

void Bo1_CableElement_Aabb::go(const shared_ptr<Shape>& shape, shared_ptr<Bound>& bound, const Se3r&, const Body*) {
    const auto& element = static_cast<const CableElement&>(*shape);
    const CableView* view = element.view(*scene);
    if (!view) return;
    if (view->model->element[element.element].kind & ANCF_WOUND) { // touches nothing
        bound.reset();
        return;
    }
    ancf_box box;
    ancf_boxes_of(&box, view->boxes, view->model, element.element);
    if (!bound) bound = shared_ptr<Bound>(new Aabb);
    // Those of a flat net differ by rounding only, which would shuffle them at each sorting: n^2 steps. On a grid they
    // are equal, unless they lie on its lines: 3.7, since bounds are often a simple part of the radius from 0.
    const Real grid = view->cover[element.element].radius / 3.7;
    for (int c = 0; c < 3; ++c) {
        bound->min[c] = grid * std::floor(box.low[c] / grid);
        bound->max[c] = grid * std::ceil(box.high[c] / grid);
    }
}

} // namespace yade
