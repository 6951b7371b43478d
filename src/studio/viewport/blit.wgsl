// The finished picture onto the window. The picture is read as linear light; a window that does not encode gets it encoded.

@group(0) @binding(0) var picture: texture_2d<f32>;
@group(0) @binding(1) var picture_sampler: sampler;

override encodes: bool = true;

struct Corner {
    @builtin(position) clip: vec4f,
    @location(0) uv: vec2f,
}

@vertex
fn corner(@builtin(vertex_index) index: u32) -> Corner {
    let at = vec2f(f32((index << 1u) & 2u), f32(index & 2u));
    return Corner(vec4f(at * vec2f(2.0, -2.0) + vec2f(-1.0, 1.0), 0.0, 1.0), at);
}

@fragment
fn shown(in: Corner) -> @location(0) vec4f {
    let light = textureSampleLevel(picture, picture_sampler, in.uv, 0.0).rgb;
    if !encodes {
        return vec4f(light, 1.0);
    }
    // sRGB by square roots, within 0.3 %: they cost a processor that plays a graphics card far less than powers.
    let second = sqrt(light);
    let fourth = sqrt(second);
    let eighth = sqrt(fourth);
    return vec4f(0.662002687 * second + 0.684122060 * fourth - 0.323583601 * eighth - 0.022541147 * light, 1.0);
}
