!> Metal that bends in one layer of elements which do not follow a bend.
!>
!> Of a strip of unit width, thickness t and yield stress Y in plane strain the plastic moment is
!> 2/sqrt(3) Y t^2/4 = .289 Y t^2. Two Gauss points of one layer lie at t/sqrt(12) from the middle.
!> With one mean dilatation (B-bar) both have the stress deviator of a bend without change of
!> volume and one mean stress, which the free faces make none: 2/3 Y along the strip, a moment of
!> 2/3 Y t^2/sqrt(12) = .192 Y t^2, a third too small. Without B-bar (plane stress, FULL) it is that
!> of two points, 15 % too large, and more where edges that stay straight keep metal from bending
!> in one place. The mesh adds no work there that lopin_mesh_work would see.
!>
!> What bends is the strain that changes sign with the parametric coordinate across the layer; the
!> work of the stresses on it, beside that on all strains, is the share of bending.
module lopin_bent_layers
   use lopin_kinds, only : wp
   use lopin_text, only : to_text
   use lopin_element_type, only : element_formulation, cells_of_words
   use lopin_cells, only : cell_type
   use lopin_flow_curve, only : flows
   use lopin_model, only : model_type
   use lopin_point_volumes, only : point_volumes
   use lopin_sheet_layers, only : find_beyond, layers_of, is_product
   use lopin_scene, only : scene_type
   use lopin_repeated_messages, only : warn_once
   implicit none
   private
   public :: check_bent_layers

   !> Of the work in the bodies, what bends such layers; and how far the moment of one is off.
   real(wp), parameter :: much = 0.1_wp
   real(wp), parameter :: mean_dilatation = 1.0_wp/3.0_wp, two_points = 0.155_wp

contains

   !> Look at all bodies where a step ends; `told` if it has been said.
   subroutine check_bent_layers(scene, model, stress, strain, along, told)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: stress(:, :)     !! (6, npoint) [stress]
      real(wp), intent(in) :: strain(:, :)     !! (6, npoint) [-]
      real(wp), intent(in) :: along            !! work of the stresses along the strains [energy]
      logical, intent(out) :: told
      type(cell_type), allocatable :: cells(:)
      integer, allocatable :: beyond(:, :)
      real(wp) :: bends, most, own
      integer :: d, e, layers(3), worst

      told = .false.
      if (.not. any([(may_bend(scene, model, e), e=1, model%mesh%nelement)])) return
      call cells_of_words(model%element_word, cells)
      call find_beyond(model, cells, beyond)
      bends = 0.0_wp
      most = 0.0_wp
      worst = 0
      do e = 1, model%mesh%nelement
         if (.not. may_bend(scene, model, e)) cycle
         layers = layers_of(model, cells, e, beyond)
         do d = 1, model%mesh%ndim
            if (layers(d) /= 1) cycle
            own = bending(e, d)
            bends = bends + own
            if (own <= most) cycle
            most = own
            worst = e
         end do
      end do
      told = bends > much*along .and. worst > 0
      if (told) call tell(scene, model, worst, bends/along)

   contains

      !> Work of the stresses on what changes across a direction of an element.
      real(wp) function bending(e, d) result(work)
         integer, intent(in) :: e, d
         real(wp), allocatable :: volume(:)
         real(wp) :: slope(6)

         associate (element => scene%solids%group(scene%solids%which(e))%element, &
            & node => model%mesh%conn(:, e), p => scene%solids%first_point(e), &
            & q => scene%solids%first_point(e + 1) - 1)
            volume = point_volumes(element, model%mesh%x(:, node(:element%nnode)), &
               & model%section(model%mesh%section(e))%thickness)
            slope = matmul(strain(:, p:q), element%xi(d, :))/sum(element%xi(d, :)**2)
            work = sum(volume*element%xi(d, :)*matmul(slope, stress(:, p:q)))
         end associate
      end function bending
   end subroutine check_bent_layers

   !> A quad or brick of first order without internal modes, of metal that flows.
   pure logical function may_bend(scene, model, e) result(may)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      integer, intent(in) :: e

      may = .false.
      if (scene%solids%which(e) == 0) return
      associate (element => scene%solids%group(scene%solids%which(e))%element, &
         & section => model%section(model%mesh%section(e)))
         if (element%nnode /= 2**element%ndim .or. element%nmode > 0) return
         if (.not. is_product(element%cell) .or. .not. any(element%formulation &
            & == [element_formulation%bbar, element_formulation%full])) return
         if (section%material == 0) return
         may = flows(model%material(section%material)%flow)
      end associate
   end function may_bend

   subroutine tell(scene, model, worst, share)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      integer, intent(in) :: worst             !! element
      real(wp), intent(in) :: share            !! of the work
      character(len=:), allocatable :: word, off

      associate (element => scene%solids%group(scene%solids%which(worst))%element, &
         & at => model%section(model%mesh%section(worst))%at)
         word = trim(model%element_word(model%mesh%etype(worst)))
         off = to_text(100.0_wp*mean_dilatation, 2)//' % too small'
         if (element%formulation == element_formulation%full) off = to_text( &
            & 100.0_wp*two_points, 2)//' % and more too large'
         call warn_once(scene%log, 'W0566', 'metal bends in one layer of '//word//', most at '// &
            & 'element '//to_text(model%mesh%element_label(worst))//', which is '// &
            & to_text(100.0_wp*min(share, 1.0_wp), 2)//' % of the work: its two points across '// &
            & 'the layer carry a plastic moment that is '//off, at, help='words with I '// &
            & '(CPE4I, CPS4I, CAX4I, C3D8I), which have more points in one layer; or three '// &
            & 'layers and more')
      end associate
   end subroutine tell
end module lopin_bent_layers
