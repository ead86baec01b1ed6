// SPDX-License-Identifier: GPL-2.0-or-later
// Errors in the threads of InteractionLoop, where nothing can be thrown: YADE would end. CableEngine and CableNewton,
// which come later in the step, throw them.
#pragma once

#include <core/Scene.hpp>

namespace yade {

void throwLater(const Scene& scene, const string& text); // the first of a step is kept
void throwLate(const Scene& scene);                      // runtime_error with that of this step, if there is one

} // namespace yade
