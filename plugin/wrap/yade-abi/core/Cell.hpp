// SPDX-License-Identifier: GPL-2.0-or-later
// Periodic cell.
#pragma once

#include <lib/serialization/Serializable.hpp>

namespace yade {

class Cell : public Serializable {
    Matrix3r _invTrsf, _trsfInc, _vGradTimesPrevH;
    Vector3r _size, _cos, _refSize;
    bool _hasShear;
    Matrix3r _shearTrsf, _unshearTrsf;
    double _glShearTrsfMatrix[16];

public:
    Matrix3r trsf, refHSize, hSize, prevHSize, velGrad, nextVelGrad, prevVelGrad;
    int homoDeform;
    bool velGradChanged;
    bool flipFlippable;

    Cell();
    bool hasShear() const { return _hasShear; }
    const Vector3r& getSize() const { return _size; }
    ANCF_PACKAGED(Cell)
};

} // namespace yade
ANCF_PACKAGED_REGISTERED(Cell)
