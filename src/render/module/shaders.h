#pragma once
// The programs of the drawing module, GLSL 3.30 core.
namespace mortise::render::module {

// Geometry of every pass. `scalar` rides along for the colour map.
inline constexpr const char* kMeshVertex = R"(#version 330 core
layout(location=0) in vec3 position;
layout(location=1) in vec3 normal;
layout(location=2) in vec2 uv;
layout(location=3) in float scalar;
uniform mat4 view_projection;
out vec3 world; out vec3 world_normal; out vec2 texel; out float value;
void main() {
  world = position; world_normal = normal; texel = vec2(uv.x, 1.0 - uv.y); value = scalar;
  gl_Position = view_projection * vec4(position, 1.0);
})";

inline constexpr const char* kDepthFragment = R"(#version 330 core
void main() {})";

// First pass of ambient occlusion: view-space normal and distance along the view axis.
inline constexpr const char* kNormalFragment = R"(#version 330 core
in vec3 world; in vec3 world_normal; in vec2 texel; in float value;
uniform mat4 view;
out vec4 normal_depth;
void main() {
  vec3 n = normalize(mat3(view) * world_normal);
  vec3 p = (view * vec4(world, 1.0)).xyz;
  if (dot(n, p) > 0.0) n = -n;
  normal_depth = vec4(n, -p.z);
})";

// One triangle that covers the image.
inline constexpr const char* kScreenVertex = R"(#version 330 core
out vec2 at;
void main() {
  vec2 p = vec2((gl_VertexID << 1) & 2, gl_VertexID & 2);
  at = p;
  gl_Position = vec4(2.0 * p - 1.0, 0.0, 1.0);
})";

// Share of the hemisphere above a pixel that nearby surfaces leave open: points on a spiral inside a half ball of radius
// `reach` count as hidden when the depth buffer is in front of them.
inline constexpr const char* kOcclusionFragment = R"(#version 330 core
in vec2 at;
uniform sampler2D normal_depth;
uniform vec2 tangent;  // tan of half the field of view, x and y
uniform float reach;
out float open;
void main() {
  vec4 g = texture(normal_depth, at);
  if (g.w <= 0.0) { open = 1.0; return; }
  vec3 p = vec3((2.0 * at - 1.0) * tangent * g.w, -g.w), n = g.xyz;
  vec3 t = normalize(abs(n.x) < 0.7 ? cross(n, vec3(1, 0, 0)) : cross(n, vec3(0, 1, 0))), b = cross(n, t);
  ivec2 cell = ivec2(gl_FragCoord.xy) & 3;
  float turn = float((cell.x * 5 + cell.y * 11) & 15) / 16.0;
  const int samples = 12;
  float hidden = 0.0;
  for (int i = 0; i < samples; ++i) {
    float u = (float(i) + 0.5) / float(samples), angle = 6.2831853 * (float(i) * 0.618034 + turn);
    float z = sqrt(1.0 - u), r = sqrt(u);               // cosine-weighted direction
    float length = reach * (0.08 + 0.92 * fract(float(i) * 0.7548777 + turn));
    vec3 q = p + n * reach * 0.02 + (t * (r * cos(angle)) + b * (r * sin(angle)) + n * z) * length;
    vec2 s = q.xy / (-q.z * tangent) * 0.5 + 0.5;
    float depth = texture(normal_depth, s).w;
    float front = -q.z - depth;
    if (depth > 0.0 && front > 0.0) hidden += clamp(1.0 - (front - reach) / reach, 0.0, 1.0);
  }
  open = 1.0 - hidden / float(samples);
})";

// Averages the 4 x 4 pattern of the pass above, without leaking over depth edges.
inline constexpr const char* kBlurFragment = R"(#version 330 core
in vec2 at;
uniform sampler2D occlusion;
uniform sampler2D normal_depth;
uniform float reach;
out float open;
void main() {
  ivec2 p = ivec2(gl_FragCoord.xy), last = textureSize(occlusion, 0) - 1;
  float d = texelFetch(normal_depth, p, 0).w, sum = 0.0, weight = 0.0;
  for (int y = -2; y < 2; ++y)
    for (int x = -2; x < 2; ++x) {
      ivec2 q = clamp(p + ivec2(x, y), ivec2(0), last);
      float w = abs(texelFetch(normal_depth, q, 0).w - d) < 0.5 * reach ? 1.0 : 0.001;
      sum += w * texelFetch(occlusion, q, 0).r;
      weight += w;
    }
  open = sum / weight;
})";

// Background, shared by the screen and by the ground that fades into it.
inline constexpr const char* kBackground = R"(#version 330 core
uniform vec3 eye, eye_up, background_top, background_bottom;
uniform int fisheye;
uniform vec2 image;
vec3 background(vec3 direction) {
  if (fisheye != 0) return mix(background_bottom, background_top, smoothstep(-0.6, 0.8, dot(direction, eye_up)));
  vec2 q = gl_FragCoord.xy / image;
  vec3 c = mix(background_bottom, background_top, smoothstep(0.0, 1.0, q.y));
  vec2 d = q - vec2(0.5, 0.45);
  return c * (1.12 - 0.55 * dot(d, d));
}
vec3 to_srgb(vec3 c) { return mix(12.92 * c, 1.055 * pow(max(c, vec3(1e-6)), vec3(1.0 / 2.4)) - 0.055, step(vec3(0.0031308), c)); }
)";

inline constexpr const char* kScreenFragment = R"(
in vec2 at;
uniform vec3 axis_x, axis_y, axis_z;
uniform vec2 tangent;
out vec4 colour;
void main() {
  vec2 q = (2.0 * at - 1.0) * tangent;
  colour = vec4(to_srgb(background(normalize(axis_z + q.x * axis_x + q.y * axis_y))), 1.0);
})";

// llvmpipe executes both sides of a branch and skips only loops, so what differs between planes and meshes is chosen when the
// program is compiled (PLANE = 0 or 1), and the costly part of a shadow is a loop of no turns where it is not needed.
// Metal-rough shading: GGX with the Smith height-correlated visibility (Heitz 2014) and Schlick's Fresnel (1994), a key light
// with a filtered shadow map, a fill and a rim light, and a procedural studio as surroundings. Tone curve: Narkowicz (2015).
inline constexpr const char* kSurfaceFragment = R"(
in vec3 world; in vec3 world_normal; in vec2 texel; in float value;
uniform vec3 colour_factor, up, key_direction, fill_direction, rim_direction, centre;
uniform float roughness, metallic, radius;
uniform int has_texture, has_scalar;
uniform float checker; uniform vec3 plane_point, plane_u, plane_v;
uniform sampler2D base; uniform sampler2D colour_map; uniform sampler2D occlusion;
uniform sampler2DShadow shadow;
uniform mat4 light;
uniform float scalar_low, scalar_high, shadow_step;
out vec4 colour;
const float pi = 3.14159265;

float ggx(float nh, float a2) { float d = nh * nh * (a2 - 1.0) + 1.0; return a2 / (pi * d * d); }
float smith(float nl, float nv, float a2) {
  return 0.5 / max(nl * sqrt(nv * nv * (1.0 - a2) + a2) + nv * sqrt(nl * nl * (1.0 - a2) + a2), 1e-5);
}
vec3 lamp(vec3 n, vec3 v, vec3 l, vec3 diffuse, vec3 f0, float a2) {
  float nl = dot(n, l);
  if (nl <= 0.0) return vec3(0.0);
  vec3 h = normalize(v + l);
  float nv = max(dot(n, v), 1e-3), f = pow(1.0 - max(dot(v, h), 0.0), 5.0);
  vec3 fresnel = f0 + (1.0 - f0) * f;
  return nl * ((1.0 - fresnel) * diffuse / pi + fresnel * min(ggx(max(dot(n, h), 0.0), a2) * smith(nl, nv, a2), 40.0));
}
// Light that a studio sends from direction d, blurred by the roughness: sky to floor, two soft boxes.
vec3 studio(vec3 d, float rough) {
  float w = 0.08 + rough;
  vec3 c = mix(vec3(0.12, 0.11, 0.105), vec3(0.50, 0.53, 0.58), smoothstep(-w, w + 0.35, dot(d, up)));
  float sharp = mix(26.0, 1.5, sqrt(rough));
  c += vec3(1.0, 0.96, 0.9) * 1.6 * exp(sharp * (dot(d, key_direction) - 1.0)) * mix(1.0, 0.25, rough);
  c += vec3(0.7, 0.82, 1.0) * 0.9 * exp(sharp * (dot(d, rim_direction) - 1.0)) * mix(1.0, 0.25, rough);
  return c;
}
float lit(vec3 p, vec3 n) {
  vec4 s = light * vec4(p + n * (0.004 * radius), 1.0);
  vec3 q = s.xyz * 0.5 + 0.5;
  if (any(lessThan(q, vec3(0.0))) || any(greaterThan(q, vec3(1.0)))) return 1.0;
  // Most pixels are far from the edge of a shadow: eight points on the rim of the filter tell.
  float rim = 0.0;
  for (int i = 0; i < 8; ++i) {
    float angle = 0.785398 * float(i);
    rim += texture(shadow, vec3(q.xy + 3.2 * shadow_step * vec2(cos(angle), sin(angle)), q.z));
  }
  bool edge = rim > 0.0 && rim < 8.0;
  float sum = edge ? 0.0 : rim, weight = edge ? 0.0 : 8.0;
  for (int y = edge ? -3 : 4; y <= 3; ++y)
    for (int x = -3; x <= 3; ++x) {
      float w = 1.0 - float(x * x + y * y) / 20.0;
      if (w <= 0.1) continue;
      sum += w * texture(shadow, vec3(q.xy + shadow_step * vec2(x, y), q.z));
      weight += w;
    }
  return sum / weight;
}
vec3 tone(vec3 c) { return clamp(c * (2.51 * c + 0.03) / (c * (2.43 * c + 0.59) + 0.14), 0.0, 1.0); }

void main() {
  vec3 to_eye = eye - world, v = normalize(to_eye), n = normalize(world_normal);
  if (dot(n, v) < 0.0 && (PLANE == 1 || !gl_FrontFacing)) n = -n;
  vec3 albedo = colour_factor;
#if PLANE
  if (checker > 0.0) {
    vec2 q = vec2(dot(world - plane_point, plane_u), dot(world - plane_point, plane_v)) / checker;
    vec2 w = max(fwidth(q), vec2(1e-4));
    // Box-filtered square wave: the integral of the sign pattern over a pixel.
    vec2 i = 2.0 * (abs(fract((q - 0.5 * w) * 0.5) - 0.5) - abs(fract((q + 0.5 * w) * 0.5) - 0.5)) / w;
    albedo *= mix(1.0, 0.78, 0.5 - 0.5 * clamp(i.x * i.y, -1.0, 1.0));
  }
#else
  if (has_texture != 0) albedo *= texture(base, texel).rgb;
#endif
  float open = texture(occlusion, gl_FragCoord.xy / image).r, ambient = open * open;
  float shade = dot(n, key_direction) > 0.0 ? lit(world, n) : 0.0;
  vec3 key = vec3(3.0, 2.9, 2.75) * shade, fill = vec3(0.55, 0.62, 0.75) * mix(open, 1.0, 0.3), radiance;
  vec3 sky = mix(vec3(0.17, 0.155, 0.15), vec3(0.42, 0.44, 0.47), 0.5 + 0.5 * dot(n, up)) * ambient;
#if PLANE  // matt: most of a picture is ground, and highlights on it only distract
  radiance = albedo * ((key * max(dot(n, key_direction), 0.0) + fill * max(dot(n, fill_direction), 0.0)) / pi + sky);
#else
  float a2 = max(roughness * roughness, 0.03); a2 *= a2;
  vec3 f0 = mix(vec3(0.04), albedo, metallic), diffuse = albedo * (1.0 - metallic);
  radiance = key * lamp(n, v, key_direction, diffuse, f0, a2) + fill * lamp(n, v, fill_direction, diffuse, f0, a2);
  radiance += vec3(0.6, 0.65, 0.7) * open * lamp(n, v, rim_direction, diffuse, f0, a2);
  vec3 fresnel = f0 + (max(vec3(1.0 - roughness), f0) - f0) * pow(1.0 - max(dot(n, v), 0.0), 5.0);
  radiance += diffuse * sky + fresnel * studio(reflect(-v, n), roughness) * ambient;
#endif
  vec3 c = to_srgb(tone(0.85 * radiance));
#if PLANE
  c = mix(c, to_srgb(background(-v)), smoothstep(2.5 * radius, 8.0 * radius, length(world - centre)));
#else
  if (has_scalar != 0) {
    float t = (value - scalar_low) / (scalar_high - scalar_low);
    vec3 m = texture(colour_map, vec2(clamp(t, 0.5 / 256.0, 255.5 / 256.0), 0.5)).rgb;
    // Little shading, so that the colours stay those of the colour bar.
    float relief = 0.80 + 0.14 * max(dot(n, key_direction), 0.0) + 0.06 * open;
    c = mix(c, m * relief, 0.9);
  }
#endif
  colour = vec4(c, 1.0);
})";

// Equidistant fisheye, r = f theta, from the six views around the camera; black outside the image circle.
inline constexpr const char* kFisheyeFragment = R"(#version 330 core
in vec2 at;
uniform sampler2DArray faces;
uniform vec2 image;
uniform float fov, reach;  // reach: tan of half the opening of a face
out vec4 colour;
void main() {
  vec2 q = (at - 0.5) * image / (0.5 * min(image.x, image.y));
  float r = length(q), theta = 0.5 * fov * r;
  vec2 w = r > 0.0 ? q / r : vec2(0.0);
  vec3 d = vec3(sin(theta) * w, cos(theta)), a = abs(d);  // right, up, forward
  int face; vec2 s;
  if (a.z >= a.x && a.z >= a.y) { face = d.z > 0.0 ? 0 : 5; s = vec2(d.x * sign(d.z), d.y) / a.z; }
  else if (a.x >= a.y) { face = d.x > 0.0 ? 1 : 2; s = vec2(-d.z * sign(d.x), d.y) / a.x; }
  else { face = d.y > 0.0 ? 3 : 4; s = vec2(d.x, -d.z * sign(d.y)) / a.y; }
  vec3 c = texture(faces, vec3(0.5 + 0.5 * s / reach, float(face))).rgb;
  float edge = fwidth(r);
  colour = vec4(c * (1.0 - smoothstep(1.0 - edge, 1.0, r)), 1.0);
})";

// Which mesh, counted from 1, and how far along the view axis.
inline constexpr const char* kMeasureFragment = R"(#version 330 core
in vec3 world; in vec3 world_normal; in vec2 texel; in float value;
uniform mat4 view;
uniform float mesh;
out vec2 seen;
void main() { seen = vec2(mesh, -(view * vec4(world, 1.0)).z); })";

// The same along the rays of an equidistant fisheye, from the six views around the camera. Between four texels of one smooth surface the
// reciprocal of the distance is linear where the surface is flat; elsewhere the nearest texel counts.
inline constexpr const char* kMeasureFisheyeFragment = R"(#version 330 core
in vec2 at;
uniform sampler2DArray faces;
uniform vec2 image;
uniform float fov, reach;
out vec2 seen;
const float smooth_surface = 1.05;  // ratio of distances of neighbouring texels below which they are of one surface
void main() {
  vec2 q = (at - 0.5) * image / (0.5 * min(image.x, image.y));
  float r = length(q), theta = 0.5 * fov * r;
  seen = vec2(0.0);
  if (r > 1.0) return;
  vec2 w = r > 0.0 ? q / r : vec2(0.0);
  vec3 d = vec3(sin(theta) * w, cos(theta)), a = abs(d);
  int face; vec2 s;
  if (a.z >= a.x && a.z >= a.y) { face = d.z > 0.0 ? 0 : 5; s = vec2(d.x * sign(d.z), d.y) / a.z; }
  else if (a.x >= a.y) { face = d.x > 0.0 ? 1 : 2; s = vec2(-d.z * sign(d.x), d.y) / a.x; }
  else { face = d.y > 0.0 ? 3 : 4; s = vec2(d.x, -d.z * sign(d.y)) / a.y; }
  ivec2 last = textureSize(faces, 0).xy - 1;
  vec2 place = (0.5 + 0.5 * s / reach) * vec2(last + 1) - 0.5, low = floor(place), part = place - low;
  ivec2 first = clamp(ivec2(low), ivec2(0), last - 1);
  vec2 t00 = texelFetch(faces, ivec3(first, face), 0).rg, t10 = texelFetch(faces, ivec3(first + ivec2(1, 0), face), 0).rg;
  vec2 t01 = texelFetch(faces, ivec3(first + ivec2(0, 1), face), 0).rg, t11 = texelFetch(faces, ivec3(first + ivec2(1, 1), face), 0).rg;
  vec2 row0 = part.x < 0.5 ? t00 : t10, row1 = part.x < 0.5 ? t01 : t11, nearest = part.y < 0.5 ? row0 : row1;
  if (nearest.x < 0.5) return;
  vec4 z = vec4(t00.y, t10.y, t01.y, t11.y);
  float least = min(min(z.x, z.y), min(z.z, z.w)), most = max(max(z.x, z.y), max(z.z, z.w));
  bool one = t00.x == t10.x && t00.x == t01.x && t00.x == t11.x && most < smooth_surface * least;
  float along = one ? 1.0 / mix(mix(1.0 / z.x, 1.0 / z.y, part.x), mix(1.0 / z.z, 1.0 / z.w, part.x), part.y) : nearest.y;
  seen = vec2(nearest.x, along / max(a.x, max(a.y, a.z)));
})";

}  // namespace mortise::render::module
