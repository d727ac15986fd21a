!> The contract of enforcement methods, on the linear and on the nonlinear path (lecture J).
!>
!> With gap g >= 0 open, force (or pressure) lambda >= 0 pressing and stiffness alpha > 0 of the
!> point (or of its area), all methods press with
!>
!>    lambda = < trial >,   <x> = max(x, 0)   (no < > where contact is bilateral)
!>
!> and differ in the trial and in what the multiplier is:
!>
!>    springs     trial(gap, alpha, multiplier) is all: the multiplier is none (penalty, pressure
!>                laws) or frozen while the system is solved, and updated afterwards (augmented)
!>    unknowns    the multiplier is solved for, with the row g + penetration(lambda) = 0 in contact
!>                (Lagrange: 0; perturbed: lambda/alpha), where what is frozen counts as no force
!>
!> A method is a file `enforcement_<name>.f90` that extends `enforcement_type` by its name and
!> `solves_for_multiplier`, and overrides what it does otherwise; its name and its parameter of
!> *SURFACE BEHAVIOR are in `lopin_enforcement_factory`.
module lopin_enforcement
   use lopin_kinds, only : wp
   implicit none
   private
   public :: enforcement_type, setting_type, copy_method

   !> Springs up to this, in moduli over a facet, suit Newton's iterations.
   real(wp), parameter :: soft_enough = 20.0_wp
   !> And up to this, in moduli over the span of a contact that rubs: all its points slip together,
   !> and springs that are stiff beside what the body opposes to that make Newton hop between stick
   !> and slip, the more the finer the mesh.
   real(wp), parameter :: soft_along = 100.0_wp

   !> What a method may look at when it chooses its form in Newton's iterations.
   type :: setting_type
      real(wp) :: stiffness = 0.0_wp   !! of the method beside the modulus over the facet [-]
      real(wp) :: span = 1.0_wp        !! facets along a contact whose points stick or slip [-]
      logical :: rubs = .false.        !! there is friction
      logical :: exact_stick = .false. !! it sticks without any slip
      logical :: elastic_slip = .false.  !! slip before sliding is given as a length
      logical :: given_slip = .false.  !! the deck says how points give way before they slide
   contains
      procedure :: is_stiff
   end type setting_type

   type, abstract :: enforcement_type
   contains
      procedure(word_if), deferred :: word
      procedure(multiplier_if), deferred :: solves_for_multiplier
      procedure :: updates => is_never_updated
      procedure :: trial => pressed_by_springs
      procedure :: penetration => no_penetration
      procedure :: stored => nothing_stored
      procedure :: update => nothing_to_update
      procedure :: piecewise_linear => is_piecewise_linear
      procedure :: first_gap => touches_at_zero
      procedure :: form_for_newton => is_its_own_form
      procedure :: forces => trial_that_presses
      ! What follows from those.
      procedure, non_overridable :: compliance
      procedure, non_overridable :: is_exact
      procedure, non_overridable :: reads_slope
   end type enforcement_type

   abstract interface
      !> Name as in charts and messages.
      function word_if(self) result(word)
         import :: enforcement_type
         class(enforcement_type), intent(in) :: self
         character(len=:), allocatable :: word
      end function word_if

      !> .true.: the force is an unknown of the linear system; .false.: it is a spring's force.
      pure logical function multiplier_if(self)
         import :: enforcement_type
         class(enforcement_type), intent(in) :: self
      end function multiplier_if
   end interface

contains

   !> A copy of a method. By intrinsic assignment some compilers keep the room of what stood there.
   subroutine copy_method(method, copy)
      class(enforcement_type), intent(in) :: method
      class(enforcement_type), allocatable, intent(out) :: copy
      allocate (copy, source=method)
   end subroutine copy_method

   !> .true.: `update` moves the multiplier after each solve, until nothing moves.
   pure logical function is_never_updated(self)
      class(enforcement_type), intent(in) :: self
      associate (unused => self)
         is_never_updated = .false.
      end associate
   end function is_never_updated

   !> Force of a spring at a gap before it is cut where it would pull, and its stiffness -d/d gap.
   elemental subroutine pressed_by_springs(self, gap, alpha, multiplier, force, stiffness)
      class(enforcement_type), intent(in) :: self
      real(wp), intent(in) :: gap          !! [length]
      real(wp), intent(in) :: alpha        !! stiffness; the weight of the point for a pressure law
                                           !! [force/length], of an area [stress/length]
      real(wp), intent(in) :: multiplier   !! that is frozen [force or stress]
      real(wp), intent(out) :: force       !! [force or stress]
      real(wp), intent(out) :: stiffness   !! [as alpha]

      associate (unused => self)
         force = multiplier - alpha*gap
         stiffness = alpha
      end associate
   end subroutine pressed_by_springs

   !> Penetration that a method which solves for the force allows under it; linear in the force.
   elemental real(wp) function no_penetration(self, force, alpha)
      class(enforcement_type), intent(in) :: self
      real(wp), intent(in) :: force   !! [force or stress]
      real(wp), intent(in) :: alpha   !! as of `trial`
      associate (unused => self, also => force, too => alpha)
         no_penetration = 0.0_wp
      end associate
   end function no_penetration

   !> Energy that the law of a point holds at a gap under a force [force*length, or per area].
   elemental real(wp) function nothing_stored(self, gap, force, alpha)
      class(enforcement_type), intent(in) :: self
      real(wp), intent(in) :: gap     !! [length]
      real(wp), intent(in) :: force   !! [force or stress]
      real(wp), intent(in) :: alpha   !! as of `trial`
      associate (unused => self, also => gap, too => force, and => alpha)
         nothing_stored = 0.0_wp
      end associate
   end function nothing_stored

   !> After a converged solve: new multipliers; `change` is what they moved by (0: nothing to do).
   elemental subroutine nothing_to_update(self, force, multiplier, change)
      class(enforcement_type), intent(in) :: self
      real(wp), intent(in) :: force
      real(wp), intent(inout) :: multiplier
      real(wp), intent(out) :: change
      associate (unused => self, also => force, too => multiplier)
         change = 0.0_wp
      end associate
   end subroutine nothing_to_update

   !> .true.: the trial is multiplier - alpha*gap, and a set of closed points decides all.
   pure logical function is_piecewise_linear(self)
      class(enforcement_type), intent(in) :: self
      associate (unused => self)
         is_piecewise_linear = .true.
      end associate
   end function is_piecewise_linear

   !> Gap at which it begins to press, >= 0 [length].
   pure real(wp) function touches_at_zero(self)
      class(enforcement_type), intent(in) :: self
      associate (unused => self)
         touches_at_zero = 0.0_wp
      end associate
   end function touches_at_zero

   !> The method that has the same limit and is solved in its place by Newton's iterations;
   !> unallocated: itself.
   subroutine is_its_own_form(self, setting, form)
      class(enforcement_type), intent(in) :: self
      type(setting_type), intent(in) :: setting
      class(enforcement_type), allocatable, intent(out) :: form
      associate (unused => self, also => setting)
         if (allocated(form)) deallocate (form)
      end associate
   end subroutine is_its_own_form

   !> Newton loses its way with springs as stiff as these: the mixed form has the same equations and
   !> does not.
   pure logical function is_stiff(self)
      class(setting_type), intent(in) :: self
      is_stiff = self%stiffness > soft_enough
      if (self%rubs) is_stiff = is_stiff .or. self%stiffness*self%span > soft_along
   end function is_stiff

   !> Force and stiffness -d force/d gap of a spring, cut where it would pull.
   elemental subroutine trial_that_presses(self, gap, alpha, multiplier, bilateral, force, &
      & stiffness)
      class(enforcement_type), intent(in) :: self
      real(wp), intent(in) :: gap, alpha, multiplier   !! as of `trial`
      logical, intent(in) :: bilateral
      real(wp), intent(out) :: force, stiffness

      call self%trial(gap, alpha, multiplier, force, stiffness)
      if (force > 0.0_wp .or. bilateral) return
      force = 0.0_wp
      stiffness = 0.0_wp
   end subroutine trial_that_presses

   !> Penetration per force [length/force].
   elemental real(wp) function compliance(self, alpha)
      class(enforcement_type), intent(in) :: self
      real(wp), intent(in) :: alpha   !! as of `trial`
      compliance = self%penetration(1.0_wp, alpha)
   end function compliance

   !> .true.: no penetration is left under a force, whatever the stiffness.
   pure logical function is_exact(self)
      class(enforcement_type), intent(in) :: self

      is_exact = self%updates()
      if (.not. is_exact .and. self%solves_for_multiplier()) &
         & is_exact = .not. self%penetration(1.0_wp, 1.0_wp) > 0.0_wp
   end function is_exact

   !> .true.: it needs a slope of pressure over penetration, from the deck or chosen.
   pure logical function reads_slope(self)
      class(enforcement_type), intent(in) :: self
      reads_slope = self%piecewise_linear() .and. (self%updates() .or. .not. self%is_exact())
   end function reads_slope
end module lopin_enforcement
