// ---------------------------------------------------------------- drawing
const SOLID_SHADER = [`#version 300 es
layout(location=0) in vec3 point; layout(location=1) in vec3 normal;
layout(location=2) in vec4 row0; layout(location=3) in vec4 row1; layout(location=4) in vec4 row2; layout(location=5) in vec4 colour;
uniform mat4 camera, light;
out vec3 world, up; out vec4 paint, shade;
void main() {
  world = vec3(dot(row0, vec4(point, 1)), dot(row1, vec4(point, 1)), dot(row2, vec4(point, 1)));
  mat3 turn = transpose(mat3(row0.xyz, row1.xyz, row2.xyz));
  // Sizes differ along the axes, so normals go by their inverses.
  up = turn * (normal / vec3(dot(turn[0], turn[0]), dot(turn[1], turn[1]), dot(turn[2], turn[2])));
  paint = colour;
  shade = light * vec4(world, 1);
  gl_Position = camera * vec4(world, 1);
}`, `#version 300 es
precision highp float; precision highp sampler2DShadow;
in vec3 world, up; in vec4 paint, shade;
uniform vec3 eye, sun, grid, sky; uniform float gridded, shadows, reach; uniform sampler2DShadow map;
out vec4 colour;
float lit() {
  vec3 p = shade.xyz / shade.w * 0.5 + 0.5;
  if (shadows < 0.5 || any(lessThan(p, vec3(0))) || any(greaterThan(p, vec3(1)))) return 1.0;
  float sum = 0.0;
  for (int i = 0; i < 9; i++) sum += texture(map, vec3(p.xy + vec2(i % 3 - 1, i / 3 - 1) * 1.3 / 2048.0, p.z - 0.0012));
  return sum / 9.0;
}
void main() {
  vec3 n = normalize(up), to = normalize(eye - world);
  if (dot(n, to) < 0.0) n = -n;
  float direct = max(dot(n, sun), 0.0) * lit();
  float ambient = 0.52 + 0.12 * n.z + 0.08 * dot(n, to);
  vec3 c = paint.rgb * (ambient + 0.42 * direct);
  if (gridded > 0.5) {
    vec2 m = abs(fract(world.xy + 0.5) - 0.5) / fwidth(world.xy);
    c = mix(c, grid, 0.7 * (1.0 - clamp(min(m.x, m.y), 0.0, 1.0)));
    c = mix(c, sky, smoothstep(0.35, 1.0, length(world.xy - eye.xy) / reach));
  }
  colour = vec4(c, paint.a);
}`];
const EDGE_SHADER = [SOLID_SHADER[0].replace('layout(location=1) in vec3 normal;', 'const vec3 normal = vec3(0, 0, 1);'), `#version 300 es
precision highp float;
in vec3 world; in vec4 paint; uniform vec4 ink; out vec4 colour;
void main() { colour = vec4(ink.rgb, ink.a * paint.a); }`];
const LINE_SHADER = [`#version 300 es
layout(location=0) in vec3 a; layout(location=1) in vec3 b; layout(location=2) in vec4 colour; layout(location=3) in float width;
uniform mat4 camera; uniform vec2 size; uniform float strength; out vec4 paint;
void main() {
  vec4 p = camera * vec4(a, 1), q = camera * vec4(b, 1);
  if (p.w < 0.01) p = mix(p, q, (0.01 - p.w) / (q.w - p.w));
  if (q.w < 0.01) q = mix(q, p, (0.01 - q.w) / (p.w - q.w));
  vec2 way = (q.xy / q.w - p.xy / p.w) * size, along = length(way) > 1e-6 ? normalize(way) : vec2(1, 0);
  vec4 end = gl_VertexID < 2 ? p : q;
  vec2 side = vec2(-along.y, along.x) * (gl_VertexID % 2 == 0 ? -1.0 : 1.0) + along * (gl_VertexID < 2 ? -0.5 : 0.5);
  end.xy += side * width / size * end.w;
  paint = vec4(colour.rgb, colour.a * strength);
  gl_Position = end;
}`, `#version 300 es
precision highp float; in vec4 paint; out vec4 colour; void main() { colour = paint; }`];

/** Draws many equal solids at once: each mesh has layers of what is solid, what is seen through, wire, and the floor with its grid. */
class Renderer {
  constructor(canvas) {
    const gl = this.gl = canvas.getContext('webgl2', { antialias: true });
    if (!gl) throw new Error('This browser has no WebGL 2: the tab “Figure” shows the plan without it.');
    this.meshes = new Map();
    this.solidProgram = this.program(SOLID_SHADER);
    this.edgeProgram = this.program(EDGE_SHADER);
    this.lineProgram = this.program(LINE_SHADER);
    [this.rims, this.tree, this.paths, this.pair, this.marks] = [1, 2, 3, 4, 5].map(() => this.lineLayer());
    this.map = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, this.map);
    gl.texStorage2D(gl.TEXTURE_2D, 1, gl.DEPTH_COMPONENT24, 2048, 2048);
    for (const [name, value] of [['MIN_FILTER', gl.LINEAR], ['MAG_FILTER', gl.LINEAR], ['WRAP_S', gl.CLAMP_TO_EDGE],
      ['WRAP_T', gl.CLAMP_TO_EDGE], ['COMPARE_MODE', gl.COMPARE_REF_TO_TEXTURE]]) gl.texParameteri(gl.TEXTURE_2D, gl['TEXTURE_' + name], value);
    this.shadowFrame = gl.createFramebuffer();
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.shadowFrame);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.TEXTURE_2D, this.map, 0);
    gl.enable(gl.DEPTH_TEST);
    gl.depthFunc(gl.LEQUAL);
    gl.blendFuncSeparate(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA, gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
  }
  program([vertex, fragment]) {
    const gl = this.gl, program = gl.createProgram();
    for (const [type, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
      const shader = gl.createShader(type);
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      gl.attachShader(program, shader);
    }
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error('The graphics driver refuses a shader: ' + gl.getProgramInfoLog(program));
    return { program, uniforms: {} };
  }
  /** Fills a buffer, a new one if none is given. */
  fill(numbers, buffer = this.gl.createBuffer()) {
    this.gl.bindBuffer(this.gl.ARRAY_BUFFER, buffer);
    this.gl.bufferData(this.gl.ARRAY_BUFFER, new Float32Array(numbers), this.gl.DYNAMIC_DRAW);
    return buffer;
  }
  attributes(list, stride, divisor) {
    let offset = 0;
    for (const [at, size] of list) {
      this.gl.enableVertexAttribArray(at);
      this.gl.vertexAttribPointer(at, size, this.gl.FLOAT, false, 4 * stride, 4 * offset);
      this.gl.vertexAttribDivisor(at, divisor);
      offset += size;
    }
  }
  /** The mesh of this name, made if it is not there yet. */
  mesh(name, make) {
    if (this.meshes.has(name)) return this.meshes.get(name);
    const gl = this.gl, { vertices, lines, low, high } = make();
    const [faces, edges] = [this.fill(vertices), this.fill(lines)];
    const array = (buffer, list, stride, instances) => {
      const array = gl.createVertexArray();
      gl.bindVertexArray(array);
      gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
      this.attributes(list, stride, 0);
      gl.bindBuffer(gl.ARRAY_BUFFER, instances);
      this.attributes([[2, 4], [3, 4], [4, 4], [5, 4]], 16, 1);
      return array;
    };
    const layer = () => {
      const instances = this.fill([]);
      return { instances, numbers: new Float32Array(16 * 16), count: 0,
        faces: array(faces, [[0, 3], [1, 3]], 6, instances), edges: array(edges, [[0, 3]], 3, instances) };
    };
    const mesh = { low, high, faceCount: vertices.length / 6, edgeCount: lines.length / 3, layers: { solid: layer(), clear: layer(), wire: layer(), ground: layer() } };
    this.meshes.set(name, mesh);
    return mesh;
  }
  clear() {
    for (const { layers } of this.meshes.values()) for (const layer of Object.values(layers)) layer.count = 0;
  }
  /** Adds a piece that stands at `pose`, to be drawn with the next frame. */
  add(mesh, name, pose, size, [r, g, b], alpha = 1) {
    const layer = mesh.layers[name];
    if (16 * layer.count === layer.numbers.length) {
      const larger = new Float32Array(2 * layer.numbers.length);
      larger.set(layer.numbers);
      layer.numbers = larger;
    }
    const [x, y, z, i, j, k, w] = pose, [sx, sy, sz] = size;
    layer.numbers.set([
      (1 - 2 * (j * j + k * k)) * sx, 2 * (i * j - k * w) * sy, 2 * (i * k + j * w) * sz, x,
      2 * (i * j + k * w) * sx, (1 - 2 * (i * i + k * k)) * sy, 2 * (j * k - i * w) * sz, y,
      2 * (i * k - j * w) * sx, 2 * (j * k + i * w) * sy, (1 - 2 * (i * i + j * j)) * sz, z, r, g, b, alpha], 16 * layer.count++);
  }
  lineLayer() {
    const gl = this.gl, array = gl.createVertexArray(), buffer = this.fill([]);
    gl.bindVertexArray(array);
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    this.attributes([[0, 3], [1, 3], [2, 4], [3, 1]], 11, 1);
    return { array, buffer, count: 0 };
  }
  /** Lines of eleven numbers each: two ends, a colour with alpha, a width in pixels. */
  setLines(layer, numbers) {
    this.fill(numbers, layer.buffer);
    layer.count = numbers.length / 11;
  }
  use({ program, uniforms }, values) {
    const gl = this.gl;
    gl.useProgram(program);
    for (const [name, value] of Object.entries(values)) {
      if (!(name in uniforms)) uniforms[name] = gl.getUniformLocation(program, name);
      if (uniforms[name] === null) continue;
      if (value.length === 16) gl.uniformMatrix4fv(uniforms[name], false, value);
      else if (value.length) gl['uniform' + value.length + 'fv'](uniforms[name], value);
      else gl.uniform1f(uniforms[name], value);
    }
  }
  drawLayer(name, part) {
    const gl = this.gl;
    for (const mesh of this.meshes.values()) {
      const layer = mesh.layers[name], count = part === 'faces' ? mesh.faceCount : mesh.edgeCount;
      if (!layer.count || !count) continue;
      gl.bindVertexArray(layer[part]);
      gl.drawArraysInstanced(part === 'faces' ? gl.TRIANGLES : gl.LINES, 0, count, layer.count);
    }
  }
  drawLines(layer) {
    this.gl.bindVertexArray(layer.array);
    if (layer.count) this.gl.drawArraysInstanced(this.gl.TRIANGLE_STRIP, 0, 4, layer.count);
  }
  /** Draws all that was added: `view` holds camera, light, eye, sun, colours and what is wanted. */
  frame(view, width, height) {
    const gl = this.gl;
    for (const { layers } of this.meshes.values()) {
      for (const { count, instances, numbers } of Object.values(layers)) {
        if (count) this.fill(numbers.subarray(0, 16 * count), instances);
      }
    }
    if (view.shadows) {
      // What is drawn to must not be bound to be read.
      gl.bindTexture(gl.TEXTURE_2D, null);
      gl.bindFramebuffer(gl.FRAMEBUFFER, this.shadowFrame);
      gl.viewport(0, 0, 2048, 2048);
      gl.clear(gl.DEPTH_BUFFER_BIT);
      gl.enable(gl.POLYGON_OFFSET_FILL);
      gl.polygonOffset(1.5, 2);
      this.use(this.edgeProgram, { camera: view.light, ink: [0, 0, 0, 0] });
      this.drawLayer('solid', 'faces');
      gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    }
    gl.bindTexture(gl.TEXTURE_2D, this.map);
    gl.viewport(0, 0, width, height);
    gl.clearColor(...view.sky, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.enable(gl.POLYGON_OFFSET_FILL);
    gl.polygonOffset(1, 1);
    this.use(this.solidProgram, { ...view, gridded: 0 });
    this.drawLayer('solid', 'faces');
    this.use(this.solidProgram, { gridded: 1 });
    this.drawLayer('ground', 'faces');
    gl.enable(gl.BLEND);
    gl.depthMask(false);
    if (view.edges) {
      this.use(this.edgeProgram, { ...view, ink: [...view.edge, 0.45] });
      this.drawLayer('solid', 'edges');
    }
    this.use(this.edgeProgram, { ...view, ink: [...view.start, 0.22] });
    this.drawLayer('wire', 'edges');
    // Lines shine through what hides them, faintly.
    const lines = strength => this.use(this.lineProgram, { ...view, size: [width, height], strength });
    for (const [layer, behind] of [[this.rims, 0.1], [this.tree, 0.25], [this.paths, 0.16], [this.pair, 0.6], [this.marks, 0.6]]) {
      lines(1);
      this.drawLines(layer);
      gl.depthFunc(gl.GREATER);
      lines(behind);
      this.drawLines(layer);
      gl.depthFunc(gl.LEQUAL);
    }
    this.use(this.solidProgram, { ...view, gridded: 0 });
    this.drawLayer('clear', 'faces');
    this.use(this.edgeProgram, { ...view, ink: [...view.edge, 0.8] });
    this.drawLayer('clear', 'edges');
    gl.disable(gl.BLEND);
    gl.depthMask(true);
  }
}

/** Matrices by column. */
function lookAt(eye, target, up) {
  const z = unit(minus(eye, target)), x = unit(cross(up, z)), y = cross(z, x);
  return [x[0], y[0], z[0], 0, x[1], y[1], z[1], 0, x[2], y[2], z[2], 0, -dot(x, eye), -dot(y, eye), -dot(z, eye), 1];
}
function perspective(angle, aspect, near, far) {
  const f = 1 / Math.tan(angle / 2);
  return [f / aspect, 0, 0, 0, 0, f, 0, 0, 0, 0, (far + near) / (near - far), -1, 0, 0, 2 * far * near / (near - far), 0];
}
const parallel = (half, near, far) => [1 / half, 0, 0, 0, 0, 1 / half, 0, 0, 0, 0, -2 / (far - near), 0, 0, 0, -(far + near) / (far - near), 1];
function matrixProduct(a, b) {
  const out = [];
  for (let column = 0; column < 4; column++) for (let row = 0; row < 4; row++) {
    out.push(a[row] * b[4 * column] + a[row + 4] * b[4 * column + 1] + a[row + 8] * b[4 * column + 2] + a[row + 12] * b[4 * column + 3]);
  }
  return out;
}

