#include "offline/compress/testing/measured_model.hpp"

#include <Eigen/Cholesky>

#include "offline/compress/measure/certificate.hpp"
#include "offline/compress/measure/contact_patches.hpp"
#include "offline/compress/measure/exact_sample.hpp"
#include "offline/compress/testing/dense_compliance.hpp"

namespace greenloop::offline::test {

MeasuredModel measure_model(const Body& body, layout::Wavelet wavelet) {
  MeasuredModel result;
  result.built = build_model({body.mesh,
                              body.flags,
                              body.area,
                              body.column_nodes,
                              columns_of(body.compliance),
                              default_accuracy,
                              wavelet,
                              facts(),
                              "{}",
                              {}},
                             {});
  const File file(result.built.model);
  const CompressedCompliance<3> compressed(file.view);
  ContactPatches patches(row_positions(body.mesh, compressed.wavelet(), compressed.finest()),
                         ExactSample::most_patches);
  patches.add(body.compliance, 0);
  result.patch_force = patches.worst_force_error(compressed, compressed.finest());
  result.certified = check_certificate(compressed, file.view.info->lambda_min, {}).holds;
  result.definite = dense_compliances(file.view).back().llt().info() == Eigen::Success;
  return result;
}

}  // namespace greenloop::offline::test
