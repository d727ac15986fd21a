!> A finite path (NLGEOM) for nothing: what the linear problem with the contact found would change.
!>
!> Strains and rotations alone say nothing of slender bodies, whose stiffness a stress changes. So
!> the linear bodies are asked: after every increment, with the forces f of the bodies on the
!> finite path and their linear stiffness K,
!>
!>    e_1 = T^-1 (f - K u),   e_2 = T^-1 (f - K (u + e_1)),
!>
!> T the tangent that Newton has factorised last, the closed points of contact in it: two back
!> substitutions. They are the first steps of an iteration that ends with the linear problem's
!> answer, and fall by a ratio that is measured: what they come to is about e_1/(1 - e_2/e_1).
!> Beside it counts what the work of all forces on a body would change by, which is of stresses too:
!> given displacements leave no e. Of bodies that store unlike energies the worst counts. Said of
!> elastic bodies without friction.
module lopin_needless_finite_path
   use lopin_kinds, only : wp
   use lopin_error, only : error_type
   use lopin_text, only : to_text
   use lopin_stream, only : stream_type
   use lopin_model, only : model_type
   use lopin_csc, only : csc_type
   use lopin_assemble_linear, only : assemble_stiffness
   use lopin_constraints, only : expand, reduce
   use lopin_newton_system, only : solve_step
   use lopin_newton_step, only : coarse
   use lopin_repeated_messages, only : note_once
   use lopin_scene, only : scene_type
   implicit none
   private
   public :: finite_path_type, measure_finite_path, tell_needless_finite_path

   !> Change [-] that is nothing, less than is told, and the fewest elements.
   real(wp), parameter :: worth_having = 0.01_wp, nothing = 1.0e-4_wp
   integer, parameter :: worth_saying = 100
   !> The ratio from which the iteration is not believed, and energies that are none.
   real(wp), parameter :: contracts = 0.5_wp, no_energy = 1.0e-12_wp

   type :: finite_path_type
      real(wp) :: most = -1.0_wp        !! largest change by increment [-]; below 0: not known
      real(wp) :: energy = 0.0_wp       !! twice the largest of all bodies [energy]
      logical :: called_for = .false.   !! some increment cannot be looked at, or needs it
   contains
      procedure :: keep
   end type finite_path_type

contains

   !> To a stream or back.
   subroutine keep(self, stream)
      class(finite_path_type), intent(inout) :: self
      type(stream_type), intent(inout) :: stream

      call stream%pass(self%most)
      call stream%pass(self%energy)
      call stream%pass(self%called_for)
   end subroutine keep

   !> After an increment under NLGEOM: the factor is that of its end. What goes up and comes back is
   !> all but flat where its step ends.
   subroutine measure_finite_path(self, scene, model)
      type(finite_path_type), intent(inout) :: self
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      real(wp) :: change

      if (self%called_for) return
      ! Where nothing moved there is nothing new.
      if (scene%newton%iterations == 0 .and. scene%newton%time < model%step(scene%step)%period) &
         & return
      self%called_for = .not. may_be_needless(scene, model)
      if (self%called_for) return
      call find_change(scene, model, self%energy, change)
      self%called_for = .not. change <= worth_having
      self%most = max(self%most, change)
   end subroutine measure_finite_path

   !> Elastic bodies whose loads keep their directions, and Newton has a factor.
   pure logical function may_be_needless(scene, model) result(may)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      integer :: i

      associate (newton => scene%newton)
         may = .not. (newton%flows .or. newton%bends) .and. newton%frictionless &
            & .and. newton%iterations > 0 .and. scene%constraints%neq > 0 &
            & .and. count(scene%solids%which > 0) >= worth_saying
         may = may .and. .not. any(model%material%has_expansion .or. model%material%has_neo_hooke)
         if (allocated(newton%follower%element)) may = may .and. size(newton%follower%element) == 0
      end associate
      do i = 1, size(model%rigid_body)
         may = may .and. size(model%rigid_body(i)%node) == 0
      end do
   end function may_be_needless

   !> Of displacements in energy and of the work of all forces, on the body where it is largest [-].
   subroutine find_change(scene, model, energy, change)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(inout) :: energy        !! twice the largest so far
      real(wp), intent(out) :: change
      type(csc_type) :: k
      type(error_type), allocatable :: error
      real(wp), dimension(scene%dofs%n) :: u, force, e, more, left
      real(wp), dimension(scene%bodies%nbody) :: whole, own, work, cross
      real(wp) :: total(2)
      integer :: i, bad

      change = huge(1.0_wp)
      k = scene%k
      call assemble_stiffness(scene%solids, model%mesh, k, error)
      if (allocated(error)) return
      u = scene%trial%motion%u(:scene%dofs%n)
      call k%multiply(u, force)
      call share_out_energy(scene, u, force, whole)
      energy = max(energy, sum(whole))
      change = 0.0_wp
      if (sum(whole) <= no_energy*energy) return
      change = huge(1.0_wp)
      call share_out_energy(scene, u, scene%newton%internal, work)
      left = scene%newton%internal - force
      do i = 1, 2
         call back_substitute(scene, left, e, bad)
         if (bad > 0) return
         call k%multiply(e, more)
         left = left - more
         call share_out_energy(scene, e, more, own)
         total(i) = sum(own)
         if (i == 2) exit
         call share_out_energy(scene, e, force, cross)
         change = max(largest_share(sqrt(max(own, 0.0_wp)), sqrt(max(whole, 0.0_wp))), &
            & largest_share(abs(work - whole - 2.0_wp*cross - own), whole))
      end do
      if (total(1) <= no_energy*sum(whole)) return
      associate (ratio => sqrt(max(total(2), 0.0_wp)/total(1)))
         change = merge(change/(1.0_wp - min(ratio, contracts)), huge(1.0_wp), ratio < contracts)
      end associate
   end subroutine find_change

   !> Displacements by the tangent that was factorised last.
   subroutine back_substitute(scene, force, u, bad)
      type(scene_type), intent(inout) :: scene
      real(wp), intent(in) :: force(:)         !! (ndof)
      real(wp), intent(out) :: u(:)            !! (ndof)
      integer, intent(out) :: bad              !! 0: there is an answer
      type(error_type), allocatable :: error
      real(wp) :: nil(scene%constraints%nprescribed), reduced(scene%constraints%neq)
      real(wp) :: right(scene%constraints%neq + scene%newton%contact%nmultiplier)
      real(wp) :: step(size(right))

      u = 0.0_wp
      right = 0.0_wp
      call reduce(scene%constraints, force, reduced)
      right(:size(reduced)) = reduced
      call solve_step(scene%newton%system, right, coarse, step, scene%clock, scene%counter, bad, &
         & error)
      if (allocated(error)) bad = max(bad, 1)
      if (bad > 0) return
      nil = 0.0_wp
      call expand(scene%constraints, step(:size(reduced)), nil, u)
   end subroutine back_substitute

   !> Twice the energy of a motion by body.
   pure subroutine share_out_energy(scene, u, force, energy)
      type(scene_type), intent(in) :: scene
      real(wp), intent(in) :: u(:), force(:)   !! (ndof)
      real(wp), intent(out) :: energy(:)       !! (nbody)
      integer :: i

      energy = 0.0_wp
      do i = 1, size(u)
         associate (body => scene%bodies%body(scene%dofs%node(i)))
            if (body > 0) energy(body) = energy(body) + u(i)*force(i)
         end associate
      end do
   end subroutine share_out_energy

   !> Of numbers by body beside others; of a body that has none of either nothing counts.
   pure real(wp) function largest_share(own, whole) result(share)
      real(wp), intent(in) :: own(:), whole(:)
      integer :: body

      share = 0.0_wp
      do body = 1, size(own)
         if (own(body) <= no_energy*sum(whole)) cycle
         share = max(share, own(body)/max(whole(body), tiny(1.0_wp)))
      end do
   end function largest_share

   !> At the end of the run.
   subroutine tell_needless_finite_path(self, scene, model)
      type(finite_path_type), intent(in) :: self
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model

      if (self%called_for .or. self%most < 0.0_wp) return
      call note_once(scene%log, 'N0369', 'NLGEOM: with linear bodies and the contact found '// &
         & 'here, displacements (in energy) and the work of the forces on a body would '// &
         & 'differ by about '//to_text(100.0_wp*max(self%most, nothing), 2)//' %', &
         & model%step(scene%step)%at, help='*STEP without NLGEOM: linear bodies take one '// &
         & 'factor in all; keep it where the shape or the loads will change more')
   end subroutine tell_needless_finite_path
end module lopin_needless_finite_path
