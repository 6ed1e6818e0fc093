#pragma once

#include "domain/reference.h"
#include "sampling/cloud.h"
#include "sampling/restricted_delaunay.h"

namespace wct::sampling {

/// One sweep of optimal Delaunay triangulation (Chen and Xu, "Optimal Delaunay triangulations"): interior points move
/// by `step` towards the mean of the circumcenters around, weighted by volume per squared size, patch points towards
/// the weighted mean of their triangles' centers, then back to their patch. Interior points keep `momentum`, a share of
/// how the last sweep moved them (Polyak 1964): they come further, and out of places where fewer sweeps would leave
/// them. Returns how far points moved in sizes, root of the mean square, of those inside or on patches, which is more.
double relax(Cloud &cloud, const domain::Reference &reference, const RestrictedDelaunay &complex, double step,
             double momentum, const Workers &workers);

/// Fill holes and thin crowds of patch points: the middles of surface edges longer than `longest` sizes become points,
/// and one end of edges shorter than `shortest` goes, but no point of a row round a square crease. Returns the number
/// of changes.
int mend(Cloud &cloud, const domain::Reference &reference, const RestrictedDelaunay &complex, double longest,
         double shortest);

} // namespace wct::sampling
