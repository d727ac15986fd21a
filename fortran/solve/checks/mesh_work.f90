!> Work in the bodies that the mesh adds to it.
!>
!> Elements that are too coarse, or lock, strain otherwise than their neighbours. With strains that
!> are smoothed, e*, by their means at nodes (of the elements of a section), the work
!>
!>    sum s : (e - e*)
!>
!> is what the mesh adds: in elasticity the square of the error in the norm of energy, as far as e*
!> is the true strain (Zienkiewicz and Zhu 1987). The force of a given way is too high by as much,
!> since all work is half of both. Of metal it is that of the stress at the end, along its strain,
!> which is the plastic work, and of metal that was bent back in places that of what was not.
!> Strains are less those of free expansion, which no stress goes with.
module lopin_mesh_work
   use lopin_kinds, only : wp
   use lopin_text, only : to_text
   use lopin_point_volumes, only : point_volumes
   use lopin_model, only : model_type
   use lopin_recover_nonlinear, only : recover_nonlinear
   use lopin_recover_stress, only : recover_stress, average_to_nodes
   use lopin_newton_workspace, only : is_nonlinear
   use lopin_material_memory, only : offset_at
   use lopin_bent_layers, only : check_bent_layers
   use lopin_scene, only : scene_type
   use lopin_repeated_messages, only : warn_once, note_once
   implicit none
   private
   public :: check_mesh_work

   !> Of all work: told, and warned of.
   real(wp), parameter :: told = 0.05_wp, warned = 0.1_wp
   !> Of the work, what must still be along the strains.
   real(wp), parameter :: still = 0.25_wp
   !> Less work than this, beside the most that was about, is what a release leaves.
   real(wp), parameter :: hardly = 1.0e-3_wp

contains

   !> Look at all bodies where a step ends.
   subroutine check_mesh_work(scene, model, u, work, plastic, whole)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: u(:, :)          !! (3, nnode) displacements [length]
      real(wp), intent(in) :: work             !! stored and spent in the bodies [energy]
      real(wp), intent(in) :: plastic          !! of that, spent [energy]
      real(wp), intent(in) :: whole            !! the most that was about [energy]
      real(wp), allocatable :: stress(:, :), strain(:, :)
      real(wp) :: added, along, most
      integer :: i, worst
      logical :: bends

      if (.not. work > hardly*whole) return
      call recover(scene, model, u, stress, strain)
      added = 0.0_wp
      along = 0.0_wp
      most = 0.0_wp
      worst = 0
      do i = 1, size(model%section)
         call add_section(i)
      end do
      ! Metal that was bent back has stresses against its strain.
      if (along < still*work) return
      bends = .false.
      if (plastic > warned*work) call check_bent_layers(scene, model, stress, strain, along, bends)
      if (bends) return
      associate (share => added/max(along, 2.0_wp*min(along, work)))
         if (share > told) call tell(scene, model, worst, share)
      end associate

   contains

      !> What the elements of a section add; the worst of all.
      subroutine add_section(section)
         integer, intent(in) :: section
         real(wp) :: smooth(6, model%mesh%nnode), own
         real(wp), allocatable :: volume(:)
         integer :: e

         associate (mesh => model%mesh, solids => scene%solids)
            call average_to_nodes(solids, mesh, strain, smooth, section)
            do e = 1, mesh%nelement
               if (mesh%section(e) /= section .or. solids%which(e) == 0) cycle
               associate (element => solids%group(solids%which(e))%element, &
                  & node => mesh%conn(:, e), p => solids%first_point(e), &
                  & q => solids%first_point(e + 1) - 1)
                  volume = point_volumes(element, mesh%x(:, node(:element%nnode)), &
                     & model%section(section)%thickness)
                  own = sum(volume*sum(stress(:, p:q)*(strain(:, p:q) - matmul( &
                     & smooth(:, node(:element%nnode)), element%n)), dim=1))
                  added = added + own
                  along = along + sum(volume*sum(stress(:, p:q)*strain(:, p:q), dim=1))
               end associate
               if (own <= most) cycle
               most = own
               worst = e
            end do
         end associate
      end subroutine add_section
   end subroutine check_mesh_work

   !> Stresses and the strains that go with them, at all points.
   subroutine recover(scene, model, u, stress, strain)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: u(:, :)          !! (3, nnode) displacements [length]
      real(wp), allocatable, intent(out) :: stress(:, :), strain(:, :)   !! (6, npoint)

      if (is_nonlinear(scene%newton)) then
         call recover_nonlinear(scene%solids, model%mesh, u, scene%newton%past, stress, strain)
         call leave_out_expansion(scene, model%mesh%nelement, strain)
      else
         call recover_stress(scene%solids, model%mesh, u, stress, strain)
      end if
   end subroutine recover

   !> What memories of heated points add to the change of volume, at each point.
   subroutine leave_out_expansion(scene, nelement, strain)
      type(scene_type), intent(in) :: scene
      integer, intent(in) :: nelement
      real(wp), intent(inout) :: strain(:, :)  !! (6, npoint) [-]
      integer :: e, k

      associate (past => scene%newton%past, solids => scene%solids)
         do e = 1, nelement
            associate (at => solids%first_point(e), own => past%first(e))
               if (past%first(e + 1) - own /= solids%first_point(e + 1) - at) cycle
               do k = 0, past%first(e + 1) - own - 1
                  strain(:3, at + k) = strain(:3, at + k) + past%value(offset_at( &
                     & solids%group(solids%which(e))%element%nstress), own + k)/3.0_wp
               end do
            end associate
         end do
      end associate
   end subroutine leave_out_expansion

   subroutine tell(scene, model, worst, share)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      integer, intent(in) :: worst             !! element
      real(wp), intent(in) :: share            !! of the work
      character(len=:), allocatable :: text, remedy

      associate (element => scene%solids%group(scene%solids%which(worst))%element, &
         & at => model%section(model%mesh%section(worst))%at)
         text = 'about '//to_text(100.0_wp*share, 2)//' % of the work in the bodies is what '// &
            & 'the mesh adds, most at element '//to_text(model%mesh%element_label(worst))//' ('// &
            & trim(model%element_word(model%mesh%etype(worst)))//'): forces of given ways are '// &
            & 'too high, ways of given forces too small, by about as much'
         remedy = 'a finer mesh; *LOPIN, TARGET ERROR= finds how fine'
         if (element%nnode == element%ndim + 1) then
            remedy = 'elements of second order, or quads and bricks; or a mesh several times finer'
         else if (element%nnode == 2**element%ndim .and. element%nmode == 0) then
            remedy = 'words with I (CPE4I, CPS4I, CAX4I, C3D8I) where bodies bend; or a finer mesh'
         end if
         if (share > warned) then
            call warn_once(scene%log, 'W0565', text, at, help=remedy)
         else
            call note_once(scene%log, 'N0565', text, at, help=remedy)
         end if
      end associate
   end subroutine tell
end module lopin_mesh_work
