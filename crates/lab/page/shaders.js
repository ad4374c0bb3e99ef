// The program of the graphics card: from light on the film to colours on the screen. The operators
// are those of `bidir tonemap`, and agree with it but for rounding.

import { MAGMA, STOPS } from "./falsecolor.js";

/** @param {number} value */
function literal(value) {
  return Number.isInteger(value) ? value.toFixed(1) : String(value);
}

/** Fills the screen with one triangle. */
export const VERTEX = `#version 300 es
void main() {
  vec2 corner = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);
  gl_Position = vec4(corner, 0.0, 1.0);
}`;

/** AgX [Sobotka22] as in [Wrensch23]; GLSL has matrices column by column. */
const AGX = `
vec3 agx(vec3 color) {
  const mat3 inset = mat3(0.842479062253094, 0.0423282422610123, 0.0423756549057051,
    0.0784335999999992, 0.878468636469772, 0.0784336,
    0.0792237451477643, 0.0791661274605434, 0.879142973793104);
  const mat3 outset = mat3(1.19687900512017, -0.0528968517574562, -0.0529716355144438,
    -0.0980208811401368, 1.15190312990417, -0.0980434501171241,
    -0.0990297440797205, -0.0989611768448433, 1.15107367264116);
  const float low = -12.47393, high = 4.026069;
  vec3 x = (clamp(log2(max(inset * color, 1e-30)), low, high) - low) / (high - low);
  vec3 coded = ((((((15.5 * x - 40.14) * x + 31.96) * x - 6.868) * x + 0.4298) * x + 0.1191) * x - 0.00232);
  return pow(clamp(outset * coded, 0.0, 1.0), vec3(2.2));
}`;

/** PBR Neutral [Khronos24]. */
const NEUTRAL = `
vec3 neutral(vec3 color) {
  const float f90 = 0.04, ks = 0.8 - f90, kd = 0.15;
  float x = min(color.r, min(color.g, color.b));
  float f = x <= 2.0 * f90 ? x - x * x / (4.0 * f90) : f90;
  color -= f;
  float p = max(color.r, max(color.g, color.b));
  if (p <= ks) return color;
  float pn = 1.0 - (1.0 - ks) * (1.0 - ks) / (p + 1.0 - 2.0 * ks);
  float g = 1.0 / (kd * (p - pn) + 1.0);
  return min(color / p * pn * g + pn * (1.0 - g), pn);
}`;

/** Luminance by magma, whose colours are coded already. */
const FALSE_COLOUR = `
vec3 magma(float t) {
  return vec3(${MAGMA.map((fit) =>
    fit.reduceRight((sum, factor) => `(${sum} * t + ${literal(factor)})`, "0.0"),
  ).join(",\n    ")});
}

vec3 falseColour(vec3 color) {
  float stops = log2(max(dot(color, vec3(0.2126, 0.7152, 0.0722)), 1e-30));
  return magma(clamp((stops - ${literal(STOPS[0])}) / ${literal(STOPS[1] - STOPS[0])}, 0.0, 1.0));
}`;

/**
 * A fragment is a pixel of the screen; what is no number is green. Where that covers many of the film, at most 8 x 8 of them are
 * averaged, as light; where it is a part of one, it has that one's colour.
 */
export const FRAGMENT = `#version 300 es
precision highp float;
precision highp sampler2D;
uniform sampler2D laneA, laneB;
uniform vec4 cropA, cropB;        // x0, y0, width, height, in pixels of the frame
uniform vec2 scaleA, scaleB;      // pixels of the frame for one of the film
uniform vec2 offset;              // of the film on the screen, device pixels from the top left
uniform float zoom;               // device pixels for one of the film
uniform float height;             // of the screen, device pixels
uniform float divide;             // where b begins, device pixels
uniform float gain;
uniform int operator;
out vec4 shown;
${AGX}
${NEUTRAL}
${FALSE_COLOUR}

vec3 coded(vec3 linear) {
  return mix(1.055 * pow(linear, vec3(1.0 / 2.4)) - 0.055, 12.92 * linear, lessThanEqual(linear, vec3(0.0031308)));
}

vec3 onScreen(vec3 light) {
  if (any(isnan(light))) return vec3(0.0, 1.0, 0.0);
  vec3 color = clamp(light * gain, 0.0, 3e38);
  if (operator == 1) return coded(agx(color));
  if (operator == 2) return coded(neutral(color));
  if (operator == 3) return clamp(falseColour(color), 0.0, 1.0);
  if (operator == 4) return min(color, 1.0);
  if (operator == 5) return clamp(magma(light.r), 0.0, 1.0);
  return coded(min(color, 1.0));
}

vec4 average(sampler2D lane, vec4 crop, vec2 at, float span) {
  int taps = clamp(int(ceil(span)), 1, 8);
  vec3 sum = vec3(0.0);
  for (int j = 0; j < taps; j++) {
    for (int i = 0; i < taps; i++) {
      vec2 shift = (vec2(i, j) + 0.5) / float(taps) - 0.5;
      ivec2 texel = ivec2(floor(at + span * shift - crop.xy));
      sum += texelFetch(lane, clamp(texel, ivec2(0), ivec2(crop.zw) - 1), 0).rgb;
    }
  }
  return vec4(sum / float(taps * taps), 1.0);
}

vec4 lookUp(sampler2D lane, vec4 crop, vec2 film, vec2 scale) {
  vec2 at = film * scale;
  bool isInside = all(greaterThanEqual(at, crop.xy)) && all(lessThan(at, crop.xy + crop.zw));
  if (!isInside) return vec4(0.0);
  vec4 light = average(lane, crop, at, scale.x / zoom);
  return vec4(onScreen(light.rgb), 1.0);
}

void main() {
  vec2 screen = vec2(gl_FragCoord.x, height - gl_FragCoord.y);
  vec2 film = (screen - offset) / zoom;
  shown = screen.x < divide ? lookUp(laneA, cropA, film, scaleA) : lookUp(laneB, cropB, film, scaleB);
}`;
