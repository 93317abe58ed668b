//! Puts all mutants of a file into it at once, each behind a switch: one build then serves them all.

use proc_macro2::Span;
use quote::ToTokens;
use syn::spanned::Spanned;
use syn::visit_mut::{self, VisitMut};
use syn::{BinOp, Expr, Lit, Stmt, UnOp, parse_quote};

/// One thing that can be changed.
#[derive(Debug, Clone)]
pub struct Mutant {
    /// Its number, from 1.
    pub number: u32,
    /// The file, relative to the package.
    pub file: String,
    /// The line in the file as it stands in the tree.
    pub line: usize,
    /// The function.
    pub function: String,
    /// What was written, and what it becomes.
    pub change: String,
}

/// Adds switches to one file after the other.
#[derive(Debug, Default)]
pub struct Planter {
    /// All mutants so far.
    pub mutants: Vec<Mutant>,
    /// Numbers that do not compile and are left out.
    pub unfit: Vec<u32>,
    next: u32,
    file: String,
    functions: Vec<String>,
}

impl Planter {
    /// For a build without the mutants that do not compile.
    pub fn without(unfit: Vec<u32>) -> Self {
        Self { unfit, ..Self::default() }
    }

    /// The text of a file with its mutants in it.
    ///
    /// # Errors
    /// That of the parser.
    pub fn plant(&mut self, file: &str, text: &str) -> syn::Result<String> {
        let mut tree = syn::parse_file(text)?;
        file.clone_into(&mut self.file);
        self.functions.clear();
        self.visit_file_mut(&mut tree);
        Ok(tree.into_token_stream().to_string())
    }

    /// A number for a change, unless it does not compile.
    fn number(&mut self, span: Span, change: String) -> Option<u32> {
        self.next += 1;
        let number = self.next;
        if self.unfit.contains(&number) {
            return None;
        }
        let function = self.functions.join("::");
        self.mutants.push(Mutant { number, file: self.file.clone(), line: span.start().line, function, change });
        Some(number)
    }

    /// `original`, or one of `others` when its switch is on. Others are made of unchanged parts: one switch is on at a time.
    fn switched(&mut self, span: Span, original: &mut Expr, others: Vec<(String, Expr)>) {
        for (change, other) in others {
            if let Some(number) = self.number(span, change) {
                let known = original.clone();
                *original = parse_quote! { (if crate::mutants::on(#number) { #other } else { #known }) };
            }
        }
    }
}

fn short(tokens: &impl ToTokens) -> String {
    let text = tokens.to_token_stream().to_string();
    let text = text.replace(" . ", ".").replace(" (", "(").replace("( ", "(").replace(" )", ")").replace("& ", "&");
    if text.chars().count() <= 48 { text } else { text.chars().take(45).chain("...".chars()).collect() }
}

/// Does a condition bind names? Those must stay where they are.
fn binds(expr: &Expr) -> bool {
    match expr {
        Expr::Let(_) => true,
        Expr::Binary(both) => binds(&both.left) || binds(&both.right),
        Expr::Paren(inner) => binds(&inner.expr),
        _ => false,
    }
}

/// A comparison turned round, a sign changed, a term dropped.
fn of_binary(both: &syn::ExprBinary) -> Vec<(String, Expr)> {
    let (a, b) = (&both.left, &both.right);
    let whole = short(both);
    let with = |op: &str, expr: Expr| (format!("`{whole}`: `{op}`"), expr);
    let drop = |which: &Expr| (format!("`{whole}`: only `{}`", short(which)), which.clone());
    match both.op {
        BinOp::Lt(_) => vec![with(">=", parse_quote!(#a >= #b))],
        BinOp::Le(_) => vec![with(">", parse_quote!(#a > #b))],
        BinOp::Gt(_) => vec![with("<=", parse_quote!(#a <= #b))],
        BinOp::Ge(_) => vec![with("<", parse_quote!(#a < #b))],
        BinOp::Eq(_) => vec![with("!=", parse_quote!(#a != #b))],
        BinOp::Ne(_) => vec![with("==", parse_quote!(#a == #b))],
        BinOp::Add(_) => vec![with("-", parse_quote!(#a - #b)), drop(a), drop(b)],
        BinOp::Sub(_) => vec![with("+", parse_quote!(#a + #b)), drop(a)],
        BinOp::Mul(_) => vec![with("/", parse_quote!(#a / #b)), drop(a)],
        BinOp::Div(_) => vec![with("*", parse_quote!(#a * #b)), drop(a)],
        BinOp::And(_) => vec![with("||", parse_quote!((#a) || (#b))), drop(a), drop(b)],
        BinOp::Or(_) => vec![with("&&", parse_quote!((#a) && (#b))), drop(a), drop(b)],
        _ => Vec::new(),
    }
}

/// A method for its opposite, or dropped.
fn of_call(call: &syn::ExprMethodCall) -> Vec<(String, Expr)> {
    let name = call.method.to_string();
    let opposite = match (&*name, call.args.len()) {
        ("min", 1) => "max",
        ("max", 1) => "min",
        ("any", 1) => "all",
        ("all", 1) => "any",
        ("is_some", 0) => "is_none",
        ("is_none", 0) => "is_some",
        ("is_ok", 0) => "is_err",
        ("is_err", 0) => "is_ok",
        ("abs" | "ceil", 0) | ("clamp", 2) => {
            let receiver = &call.receiver;
            return vec![(format!("`{}`: without `{name}`", short(call)), parse_quote!(#receiver))];
        }
        _ => return Vec::new(),
    };
    let other = syn::ExprMethodCall { method: syn::Ident::new(opposite, call.method.span()), ..call.clone() };
    vec![(format!("`{}`: `{opposite}`", short(call)), Expr::MethodCall(other))]
}

/// A number off by one or doubled, a truth turned round.
fn of_literal(lit: &Lit) -> Vec<(String, Expr)> {
    let with = |text: String| match syn::parse_str::<Expr>(&text) {
        Ok(expr) => vec![(format!("`{}`: `{text}`", short(lit)), expr)],
        Err(_) => Vec::new(),
    };
    match lit {
        Lit::Int(int) => {
            int.base10_parse::<u64>().map_or_else(|_| Vec::new(), |n| with(format!("{}{}", n + 1, int.suffix())))
        }
        Lit::Float(float) => float.base10_parse::<f64>().map_or_else(
            |_| Vec::new(),
            |x| with(format!("{:?}{}", if x == 0.0 { 1.0 } else { 2.0 * x }, float.suffix())),
        ),
        Lit::Bool(truth) => with((!truth.value).to_string()),
        _ => Vec::new(),
    }
}

impl VisitMut for Planter {
    fn visit_item_mod_mut(&mut self, module: &mut syn::ItemMod) {
        if module.attrs.iter().all(|attr| !attr.path().is_ident("cfg")) {
            visit_mut::visit_item_mod_mut(self, module);
        }
    }

    fn visit_item_impl_mut(&mut self, item: &mut syn::ItemImpl) {
        let of_trait =
            item.trait_.as_ref().and_then(|(path, _)| path.segments.last()).map(|last| last.ident.to_string());
        if of_trait.as_deref().is_some_and(|name| ["Debug", "Display", "Clone", "Error"].contains(&name)) {
            return;
        }
        let whose = item.self_ty.to_token_stream().to_string().split(['<', ' ']).next().unwrap_or_default().to_owned();
        self.functions.push(whose);
        visit_mut::visit_item_impl_mut(self, item);
        self.functions.pop();
    }

    fn visit_impl_item_fn_mut(&mut self, function: &mut syn::ImplItemFn) {
        if function.sig.constness.is_none() {
            self.functions.push(function.sig.ident.to_string());
            self.visit_block_mut(&mut function.block);
            self.functions.pop();
        }
    }

    fn visit_item_fn_mut(&mut self, function: &mut syn::ItemFn) {
        if function.sig.constness.is_none() {
            self.functions.push(function.sig.ident.to_string());
            self.visit_block_mut(&mut function.block);
            self.functions.pop();
        }
    }

    // Constants, types, patterns and attributes stay: they cannot hold a switch.
    fn visit_item_const_mut(&mut self, _: &mut syn::ItemConst) {}
    fn visit_item_static_mut(&mut self, _: &mut syn::ItemStatic) {}
    fn visit_impl_item_const_mut(&mut self, _: &mut syn::ImplItemConst) {}
    fn visit_type_mut(&mut self, _: &mut syn::Type) {}
    fn visit_pat_mut(&mut self, _: &mut syn::Pat) {}
    fn visit_attribute_mut(&mut self, _: &mut syn::Attribute) {}
    fn visit_generic_argument_mut(&mut self, _: &mut syn::GenericArgument) {}
    fn visit_expr_repeat_mut(&mut self, repeat: &mut syn::ExprRepeat) {
        self.visit_expr_mut(&mut repeat.expr);
    }

    fn visit_stmt_mut(&mut self, stmt: &mut Stmt) {
        let pristine = stmt.clone();
        visit_mut::visit_stmt_mut(self, stmt);
        let Stmt::Expr(expr, Some(_)) = &pristine else { return };
        let is_effect = match expr {
            Expr::Assign(_) | Expr::MethodCall(_) => true,
            Expr::Binary(both) => {
                matches!(both.op, BinOp::AddAssign(_) | BinOp::SubAssign(_) | BinOp::MulAssign(_) | BinOp::DivAssign(_))
            }
            _ => false,
        };
        if is_effect && let Some(number) = self.number(expr.span(), format!("without `{}`", short(expr))) {
            *stmt = parse_quote! { if !crate::mutants::on(#number) { #stmt } };
        }
    }

    fn visit_expr_mut(&mut self, expr: &mut Expr) {
        let pristine = expr.clone();
        visit_mut::visit_expr_mut(self, expr);
        let others = match &pristine {
            Expr::Binary(both) if !binds(&pristine) => of_binary(both),
            Expr::MethodCall(call) => of_call(call),
            Expr::Lit(lit) => of_literal(&lit.lit),
            Expr::Unary(unary) if !matches!(unary.op, UnOp::Deref(_)) => {
                let inner = (*unary.expr).clone();
                vec![(format!("`{}`: without the sign", short(unary)), inner)]
            }
            _ => Vec::new(),
        };
        self.switched(pristine.span(), expr, others);
    }
}
