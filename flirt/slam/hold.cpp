#include "flirt/slam/hold.hpp"

#include <Eigen/Core>
#include <Eigen/Eigenvalues>

#include <algorithm>

namespace flirt {

Hold hold_of(const SurfacePoints& points) {
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  int surfaces = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (points.normal_x[i] == 0 && points.normal_y[i] == 0) { continue; }
    const double nx = points.normal_x[i];
    const double ny = points.normal_y[i];
    const Eigen::Vector3d jacobian(nx, ny, points.x[i] * ny - points.y[i] * nx);
    information += jacobian * jacobian.transpose();
    ++surfaces;
  }
  if (surfaces == 0) { return {}; }
  const double heading = std::max(information(2, 2), 1e-9);
  const Eigen::Matrix2d translation = information.topLeftCorner<2, 2>() - information.topRightCorner<2, 1>() *
                                                                              information.bottomLeftCorner<1, 2>() /
                                                                              heading;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver(translation);
  const Eigen::Vector2d direction = solver.eigenvectors().col(0);
  return {solver.eigenvalues().x() / surfaces, {direction.x(), direction.y()}};
}

}  // namespace flirt
