// SPDX-License-Identifier: GPL-2.0-or-later
// The running program: scenes and known classes.
#pragma once

#include <lib/base/Math.hpp>
#include <lib/base/Singleton.hpp>

namespace yade {

class Scene;

class Omega : public Singleton<Omega> {
public:
    const shared_ptr<Scene>& getScene() const;
    bool isRunning();
};

} // namespace yade
