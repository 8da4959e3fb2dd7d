// All that lumo adds to the host, and the one file of this sample that knows both: indirect light for the host's
// G-buffer, by cones through voxels of the host's scene.
#pragma once

#include <memory>

#include "samples/embed-gl/host.hpp"

namespace embed {

class Gi {
  public:
    /// Takes the host's context, scene and textures; the host outlives it. Throws std::runtime_error with what lumo
    /// said.
    explicit Gi(const Host& host);
    ~Gi();
    Gi(const Gi&) = delete;
    Gi& operator=(const Gi&) = delete;

    /// Between two draws of the host's: from its G-buffer into its irradiance texture.
    void record(const Camera& camera);

  private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

}  // namespace embed
