// Surefoot's contacts and events as Unity's animation events and Animator curves.
//
{{head}}
//
// Put this file into a folder called Editor and the .events.json beside the model (glTFast or UnityGLTF import the .glb). Needs the package
// com.unity.nuget.newtonsoft-json. Select the model, then Assets > Surefoot > Make clips with events: an imported clip cannot be changed, so
// each becomes a .anim beside the model. A component of the animated object receives them:
//   void SurefootEvent(AnimationEvent e) { /* e.stringParameter is "foot_down_Left", "push_start", ... */ }
using System.Collections.Generic;
using System.IO;
using System.Linq;
using Newtonsoft.Json.Linq;
using UnityEditor;
using UnityEngine;

public static class SurefootEvents
{
    const string Receiver = "SurefootEvent";

    static string Foot(JToken token) =>
        (string)token["foot"] switch { "left" => "{{left}}", "right" => "{{right}}", _ => "" };

    [MenuItem("Assets/Surefoot/Make clips with events")]
    static void MakeClips()
    {
        foreach (var model in Selection.objects)
        {
            var path = AssetDatabase.GetAssetPath(model);
            var sidecar = Path.ChangeExtension(path, ".events.json");
            if (!File.Exists(sidecar))
            {
                Debug.LogError($"surefoot: there is no {sidecar}");
                continue;
            }
            var reports = JObject.Parse(File.ReadAllText(sidecar));
            foreach (var source in AssetDatabase.LoadAllAssetsAtPath(path).OfType<AnimationClip>())
            {
                if (reports[source.name] is JObject report)
                {
                    MakeClip(source, report, Path.GetDirectoryName(path));
                }
            }
        }
        AssetDatabase.SaveAssets();
    }

    static void MakeClip(AnimationClip source, JObject report, string folder)
    {
        var clip = Object.Instantiate(source);
        clip.name = source.name;
        var events = new List<AnimationEvent>();
        foreach (var told in report["events"])
        {
            var foot = Foot(told);
            events.Add(new AnimationEvent
            {
                time = Mathf.Min((float)told["time"], clip.length),
                functionName = Receiver,
                stringParameter = foot == "" ? (string)told["name"] : $"{told["name"]}_{foot}",
                messageOptions = SendMessageOptions.DontRequireReceiver,
            });
        }
        AnimationUtility.SetAnimationEvents(clip, events.OrderBy(e => e.time).ToArray());
        foreach (var foot in new[] { "left", "right" })
        {
            var name = foot == "left" ? "{{left}}" : "{{right}}";
            var binding = EditorCurveBinding.FloatCurve("", typeof(Animator), $"FootContact_{name}");
            AnimationUtility.SetEditorCurve(clip, binding, ContactCurve(report, foot, clip.length));
        }
        var lower = clip.name.ToLowerInvariant();
        var settings = AnimationUtility.GetAnimationClipSettings(clip);
        settings.loopTime = new[] { "loop", "cycle" }.Any(word => lower.StartsWith(word) || lower.EndsWith(word));
        AnimationUtility.SetAnimationClipSettings(clip, settings);
        var file = string.Concat(clip.name.Split(Path.GetInvalidFileNameChars()));
        AssetDatabase.CreateAsset(clip, $"{folder}/{file}.anim");
    }

    // 1 while any part of the foot is on the ground, 0 else, in steps.
    static AnimationCurve ContactCurve(JObject report, string foot, float length)
    {
        var keys = new List<Keyframe>();
        void Step(float time, float value) =>
            keys.Add(new Keyframe(time, value, float.PositiveInfinity, float.PositiveInfinity));
        var end = -1f; // of the span so far; parts of a foot follow on one another
        foreach (var contact in report["contacts"].Where(c => (string)c["foot"] == foot).OrderBy(c => (float)c["start"]))
        {
            var start = (float)contact["start"];
            if (start > end + 1e-3f)
            {
                if (end >= 0f)
                {
                    Step(end, 0f);
                }
                else if (start > 0f)
                {
                    Step(0f, 0f);
                }
                Step(start, 1f);
            }
            end = Mathf.Max(end, (float)contact["end"]);
        }
        if (keys.Count == 0)
        {
            Step(0f, 0f);
        }
        else if (end < length - 1e-3f)
        {
            Step(end, 0f);
        }
        return new AnimationCurve(keys.ToArray());
    }
}
