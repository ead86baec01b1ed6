// SPDX-License-Identifier: GPL-2.0-or-later
// Cables follow the materials that they are made of.
#include "CableEngine.hpp"

#include "HollarsMat.hpp"
#include "text.hpp"

namespace yade {

void CableEngine::madeOf(int first, int material, bool bends) {
    const auto& all = theScene().materials;
    const int least = sections.empty() ? 0 : sections.back();
    if (first < least || first >= nElements())
        throw std::invalid_argument(text("CableEngine.madeOf: first = ", first, ": must be from ", least,
                                         ", behind what follows a material already, to ", nElements() - 1));
    const auto* mat = material >= 0 && material < static_cast<int>(all.size())
                          ? dynamic_cast<const HollarsMat*>(all[static_cast<size_t>(material)].get())
                          : nullptr;
    if (!mat)
        throw std::invalid_argument(
            text("CableEngine.madeOf: material = ", material, ": must be the id of a HollarsMat in O.materials"));
    sections.insert(sections.end(), {first, nElements()});
    sectionMaterials.push_back(material);
    sectionBends.push_back(bends);
    sectionYoung.push_back(mat->young);
    sectionDensity.push_back(mat->density);
}

// Stiffnesses and masses in the ratio in which the materials were edited since they were last looked at.
bool CableEngine::followMaterials() {
    needSound();
    const auto& all = theScene().materials;
    const size_t n = sectionMaterials.size();
    bool any = false;
    for (size_t k = 0; k < n; ++k) {
        const auto id = static_cast<size_t>(sectionMaterials[k]);
        const ElastMat* mat = id < all.size() ? dynamic_cast<const ElastMat*>(all[id].get()) : nullptr;
        if (!mat) refuse(text("sectionMaterials[", k, "] = ", sectionMaterials[k], ": there is no such HollarsMat"));
        if (mat->young == sectionYoung[k] && mat->density == sectionDensity[k]) continue;
        const Real stiffer = mat->young / sectionYoung[k], heavier = mat->density / sectionDensity[k];
        const int first = sections[2 * k], end = sections[2 * k + 1];
        for (int e = first; e < end; ++e) {
            ea[e] *= stiffer;
            rhoA[e] *= heavier;
            if (sectionBends[k]) ei[e] *= stiffer;
        }
        sectionYoung[k] = mat->young;
        sectionDensity[k] = mat->density;
        any = true;
    }
    if (any) changed();
    return any;
}

} // namespace yade
