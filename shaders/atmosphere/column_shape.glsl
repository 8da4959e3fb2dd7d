// The table of columns: for a point and a ray that rises from it to space, the integral of each species' density. What
// is stored is near 1 everywhere: the integral over (density · scale height · flat), where
// flat = 2 / (mu + sqrt(mu² + shape)) has the two limits of Chapman's function, sqrt(pi r / (2 H)) at mu = 0 and about
// 1 / mu - H / (r mu³) upward. Ozone has no density at the point to be relative to, and is in km over flat.
vec3 column_flat(float mu) { return 2.0 / (mu + sqrt(mu * mu + air.column_shape.xyz)); }

float column_place(float mu) { return mu * (1.0 + air.column_shape.w) / (mu + air.column_shape.w); }
float column_mu(float place) { return air.column_shape.w * place / (1.0 + air.column_shape.w - place); }
