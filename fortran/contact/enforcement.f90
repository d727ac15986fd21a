!> Enforcement of contact: one formula, four policies (seed J).
!>
!> With gap g >= 0 open, nodal force lambda >= 0 pressing and nodal stiffness alpha > 0, all methods
!> press with
!>
!>    lambda = < a*multiplier - alpha*g >,   <x> = max(x, 0)   (no < > where contact is bilateral)
!>
!> and differ in what the multiplier is: penalty has none (a = 0); the augmented Lagrangian keeps it
!> frozen while it solves and updates it afterwards; Lagrange and the perturbed Lagrangian solve for
!> it, with the row g + compliance*lambda = 0 in contact, compliance = 0 or 1/alpha. A method is a
!> file `enforcement_<name>.f90` and a `case` in `new_enforcement`.
module lopin_enforcement
   use lopin_kinds, only : wp
   implicit none
   private
   public :: enforcement_type

   type, abstract :: enforcement_type
   contains
      procedure(word_if), deferred :: word
      procedure(multiplier_if), deferred :: solves_for_multiplier
      procedure :: compliance => no_compliance
      procedure :: forces => pressed_by_springs
      procedure :: stored => nothing_stored
      procedure :: update => nothing_to_update
      procedure :: piecewise_linear => is_piecewise_linear
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

   !> Penetration per force that the method allows at a point [length/force].
   elemental real(wp) function no_compliance(self, alpha)
      class(enforcement_type), intent(in) :: self
      real(wp), intent(in) :: alpha   !! nodal stiffness [force/length]
      associate (unused => self, also => alpha)
         no_compliance = 0.0_wp
      end associate
   end function no_compliance

   !> Energy that the law of a point holds at a gap [force*length].
   elemental real(wp) function nothing_stored(self, gap, alpha)
      class(enforcement_type), intent(in) :: self
      real(wp), intent(in) :: gap     !! [length]
      real(wp), intent(in) :: alpha   !! as of `forces`
      associate (unused => self, also => gap, too => alpha)
         nothing_stored = 0.0_wp
      end associate
   end function nothing_stored

   !> Force and stiffness -d force/d gap of a spring at the given gap; the multiplier shifts it.
   elemental subroutine pressed_by_springs(self, gap, alpha, multiplier, bilateral, force, &
      & stiffness)
      class(enforcement_type), intent(in) :: self
      real(wp), intent(in) :: gap          !! [length]
      real(wp), intent(in) :: alpha        !! nodal stiffness [force/length]
      real(wp), intent(in) :: multiplier   !! [force]
      logical, intent(in) :: bilateral
      real(wp), intent(out) :: force       !! [force]
      real(wp), intent(out) :: stiffness   !! [force/length]

      associate (unused => self)
         force = multiplier - alpha*gap
         stiffness = alpha
         if (force > 0.0_wp .or. bilateral) return
         force = 0.0_wp
         stiffness = 0.0_wp
      end associate
   end subroutine pressed_by_springs

   !> .true.: the force is linear in the gap as long as the point stays closed.
   pure logical function is_piecewise_linear(self)
      class(enforcement_type), intent(in) :: self
      associate (unused => self)
         is_piecewise_linear = .true.
      end associate
   end function is_piecewise_linear

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
end module lopin_enforcement
