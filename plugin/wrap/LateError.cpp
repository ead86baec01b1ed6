// SPDX-License-Identifier: GPL-2.0-or-later
#include "LateError.hpp"

#include <atomic>
#include <mutex>
#include <stdexcept>

namespace yade {

namespace {
    std::atomic<bool> any {false};
    std::mutex mutex;
    const Scene* where = nullptr;
    long when = -1;
    string what;
} // namespace

void throwLater(const Scene& scene, const string& text) {
    const std::lock_guard<std::mutex> lock(mutex);
    if (any && where == &scene && when == scene.iter) return;
    where = &scene;
    when = scene.iter;
    what = text;
    any = true;
}

void throwLate(const Scene& scene) {
    if (!any) return;
    const std::lock_guard<std::mutex> lock(mutex);
    any = false;
    if (where == &scene && when == scene.iter) throw std::runtime_error(what);
}

} // namespace yade
