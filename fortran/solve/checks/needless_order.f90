!> Elements of second order for nothing: what linear ones in the same cells would leave out.
!>
!> Of all fields of linear elements none is nearer to the solution in energy than the one that their
!> own problem has (Cea's lemma), so that also the straight part of the displacements, through the
!> corners, is no nearer. What the middles of edges have beside it bounds the error of linear
!> elements: its root beside the whole that of stresses, itself that of the work of all forces. Of
!> bodies that store unlike energies the worst counts. Said of straight cells in linear scenes only.
module lopin_needless_order
   use lopin_kinds, only : wp
   use lopin_text, only : to_text
   use lopin_stream, only : stream_type
   use lopin_model, only : model_type
   use lopin_element_type, only : element_type
   use lopin_gradients, only : is_curved
   use lopin_solid_small, only : strain_matrices, strains
   use lopin_solids, only : solids_type, group_type
   use lopin_scene, only : scene_type
   use lopin_repeated_messages, only : note_once
   implicit none
   private
   public :: needless_type, measure_middles, tell_needless_order

   !> Error of stresses [-] that is worth a third of the equations, and the fewest elements.
   real(wp), parameter :: worth_having = 0.01_wp
   integer, parameter :: worth_saying = 100
   !> Less is told as this.
   real(wp), parameter :: nothing = 1.0e-4_wp

   type :: needless_type
      real(wp) :: most = -1.0_wp        !! largest error of stresses by step [-]; below 0: not known
      logical :: called_for = .false.   !! some step cannot be looked at
   contains
      procedure :: keep
   end type needless_type

contains

   !> To a stream or back.
   subroutine keep(self, stream)
      class(needless_type), intent(inout) :: self
      type(stream_type), intent(inout) :: stream

      call stream%pass(self%most)
      call stream%pass(self%called_for)
   end subroutine keep

   !> Look at the end of a step.
   subroutine measure_middles(self, scene, model, u)
      type(needless_type), intent(inout) :: self
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: u(:, :)          !! (>= ndim, nnode) displacements [length]
      real(wp) :: energy(2, scene%bodies%nbody)
      integer :: k

      if (self%called_for) return
      self%called_for = scene%newton%in_use .or. any(model%material%has_expansion) &
         & .or. .not. may_be_needless(scene%solids, model)
      if (self%called_for) return
      energy = energies(scene, model, u)
      do k = 1, size(energy, 2)
         if (energy(2, k) > 0.0_wp) self%most = max(self%most, sqrt(energy(1, k)/energy(2, k)))
      end do
   end subroutine measure_middles

   !> Solids of second order throughout, in straight cells.
   pure logical function may_be_needless(solids, model) result(yes)
      type(solids_type), intent(in) :: solids
      type(model_type), intent(in) :: model
      integer :: e

      yes = count(solids%which > 0) >= worth_saying
      do e = 1, model%mesh%nelement
         if (.not. yes) return
         if (solids%which(e) == 0) cycle
         associate (element => solids%group(solids%which(e))%element)
            yes = element%cell%quadratic
            if (yes) yes = .not. is_curved(element, model%mesh%x(:element%ndim, &
               & model%mesh%conn(:element%nnode, e)))
         end associate
      end do
   end function may_be_needless

   !> Twice the energy of what the middles of edges have beside the straight part, and of all, by
   !> body.
   function energies(scene, model, u) result(energy)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: u(:, :)
      real(wp) :: energy(2, scene%bodies%nbody)
      integer :: e

      energy = 0.0_wp
      do e = 1, model%mesh%nelement
         if (scene%solids%which(e) == 0) cycle
         associate (group => scene%solids%group(scene%solids%which(e)))
            associate (node => model%mesh%conn(:group%element%nnode, e))
               associate (body => scene%bodies%body(node(1)))
                  energy(:, body) = energy(:, body) + of_element(group, group%element, &
                     & model%mesh%x(:, node), u(:group%element%ndim, node))
               end associate
            end associate
         end associate
      end do
   end function energies

   pure function of_element(group, element, x, u) result(energy)
      type(group_type), intent(in) :: group
      type(element_type), intent(in) :: element
      real(wp), intent(in) :: x(:, :), u(:, :)
      real(wp) :: energy(2)
      real(wp) :: b(element%ndof, element%nstress, element%ngauss), volume(element%ngauss)
      real(wp) :: strain(element%nstress, element%ngauss), part(element%ndim, element%nnode)
      real(wp) :: smallest
      integer :: point, k, i

      call strain_matrices(element, x, group%thickness, b, volume, smallest, point, group%d)
      part = 0.0_wp
      associate (n => element%cell%ncorner)
         do k = 1, element%nnode - n
            part(:, n + k) = u(:, n + k) - 0.5_wp*(u(:, element%cell%edge(1, k)) &
               & + u(:, element%cell%edge(2, k)))
         end do
      end associate
      do i = 1, 2
         if (i == 2) part = u
         call strains(element, b, reshape(part, [element%ndof]), strain)
         energy(i) = sum([(volume(k)*dot_product(strain(:, k), matmul(group%d, strain(:, k))), &
            & k=1, element%ngauss)])
      end do
   end function of_element

   !> At the end of the run.
   subroutine tell_needless_order(self, scene, model)
      type(needless_type), intent(in) :: self
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      logical :: middle(model%mesh%nnode)
      integer :: e

      if (self%called_for .or. self%most < 0.0_wp .or. self%most > worth_having) return
      middle = .false.
      do e = 1, model%mesh%nelement
         if (scene%solids%which(e) == 0) cycle
         associate (element => scene%solids%group(scene%solids%which(e))%element)
            middle(model%mesh%conn(element%cell%ncorner + 1:element%nnode, e)) = .true.
         end associate
      end do
      call note_once(scene%log, 'N0368', 'elements of second order: linear ones in the same '// &
         & 'cells would leave at most '//to_text(100.0_wp*max(self%most, nothing), 2)//' % of '// &
         & 'the stresses in the mean and '//to_text(100.0_wp*max(self%most, nothing)**2, 2)// &
         & ' % of the work of all forces on a body, without '//to_text(count(middle))//' of '// &
         & to_text(model%mesh%nnode)//' nodes', &
         & model%step(scene%step)%at, help='CPE4 for CPE8, C3D8 for C3D20; keep them where '// &
         & 'pressures of single points count, or surface to surface')
   end subroutine tell_needless_order
end module lopin_needless_order
